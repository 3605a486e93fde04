// The page of a finished map: densities stand at a grid of the plane, and one row of it at a time is what the rest of the page knows as the sweep.

class MapSource extends StoredSource {
  static async load(told) {
    const source = await super.load(told);
    source.all = source.frames;
    source.all.forEach((frame, i) => { frame.second = told.across[i]; });
    source.seconds = [...new Set(told.across)].sort((a, b) => a - b);
    source.rows = source.seconds.map((second) => source.all.filter((frame) => frame.second === second).sort((a, b) => a.value - b.value));
    source.rows.forEach((row) => row.forEach((frame, index) => { frame.index = index; }));
    source.takeRow(Math.floor(source.rows.length / 2));
    return source;
  }

  /** Makes a row the sweep. */
  takeRow(row) {
    this.row = clamp(row, 0, this.rows.length - 1);
    this.frames = this.rows[this.row];
    this.values = this.frames.map((frame) => frame.value);
  }

  nearestRow(second) {
    const away = this.seconds.map((one) => Math.abs(one - second));
    return away.indexOf(Math.min(...away));
  }
}

class MapPage extends Page {
  /** The side of the plane along which the rows follow each other. */
  get side() {
    return this.scene.plane.sides[1];
  }

  takeRow(row) {
    this.source.takeRow(row);
    this.scene.labels = this.crossings(this.source.seconds[this.source.row]);
    delete this.drawn.diagram;
    delete this.drawn.numbers;
  }

  /** Where the curves of the plane cross a row, by straight lines between their points: labels as a sweep's located changes have them. */
  crossings(second) {
    const [{ from, to }] = this.scene.plane.sides;
    const shapes = this.scene.plane.found.curves.filter((curve) => curve.observable !== null);
    const labels = shapes.flatMap((curve) => curve.points.slice(1).flatMap((b, i) => {
      const a = curve.points[i];
      if ((a[1] - second) * (b[1] - second) > 0 || a[1] === b[1]) return [];
      const share = (second - a[1]) / (b[1] - a[1]);
      const [value, error] = [a[0] + share * (b[0] - a[0]), (to - from) * Math.max(a[2], b[2])];
      return [{ label: curve.name, kind: "bifurcation", value, lower: value - error, upper: value + error, observable: curve.observable }];
    }));
    // A point that lies on the row belongs to two pieces.
    return labels.sort((a, b) => a.value - b.value).filter((one, i, all) => !i || one.label !== all[i - 1].label || one.value - all[i - 1].value > 1e-9 * (to - from));
  }

  /** Goes to the node nearest to a place of the plane. */
  goPlane([first, second]) {
    this.takeRow(this.source.nearestRow(second));
    this.go(first);
  }

  /** To another row at the same value of the first parameter. */
  climb(by) {
    const { value } = this.frame;
    this.takeRow(this.source.row + by);
    this.go(value);
  }

  draw() {
    super.draw();
    const { side, source } = this;
    $("diagram-legend").textContent = "Red dots are peaks, white circles valleys. Lines are where the curves of the plane cross; solid ones are of this density.";
    fill($("diagram-name"), "Along ", nodes(this.scene.swept.symbol), " at ", nodes(side.symbol), ` = ${plainNumber(source.seconds[source.row], 4)}`);
  }

  writeControls() {
    super.writeControls();
    const [range, text] = document.querySelectorAll("#parameters input");
    range.value = String(this.source.row);
    range.setAttribute("aria-valuetext", plainNumber(this.frame.second, 6));
    if (document.activeElement !== text) text.value = String(Number(this.frame.second.toPrecision(9)));
  }

  state() {
    const { pinned } = this;
    return { ...super.state(), [this.side.name]: this.frame.second, pin: pinned ? `${pinned.value} ${pinned.second}` : null };
  }

  restorePlace(state, numeric) {
    const { scene, source } = this;
    const nearest = (first, second) => {
      const row = source.rows[source.nearestRow(second)];
      return row.reduce((best, one) => (Math.abs(one.value - first) < Math.abs(best.value - first) ? one : best));
    };
    const middle = (side) => 0.5 * (side.from + side.to);
    const [one, other] = scene.plane.sides;
    const frame = nearest(numeric(state[one.name]) ?? middle(one), numeric(state[other.name]) ?? middle(other));
    this.takeRow(source.seconds.indexOf(frame.second));
    const pinned = (state.pin ?? "").split(" ").map(numeric);
    this.frame = frame;
    this.pin(pinned.length === 2 && pinned.every((value) => value !== null) ? nearest(...pinned) : null);
    this.show(frame.index);
  }

  /** A typed value of the second parameter: goes to the nearest row, or says why not. */
  typeSecond(words) {
    const value = Number(words.trim().replace("−", "-").replace(",", "."));
    const { symbol, from, to } = this.side;
    const wrong = words.trim() === "" || !Number.isFinite(value) ? `“${words}” is not a number.`
      : value < from || value > to ? `${plain(symbol)} was mapped from ${plainNumber(from, 6)} to ${plainNumber(to, 6)}: ${plainNumber(value, 6)} lies outside.` : "";
    $("refused").textContent = wrong;
    if (!wrong) this.goPlane([this.frame.value, value]);
  }
}

/** A slider and a typed value for the second parameter. */
const buildSecond = (page) => {
  const { side, source } = page;
  const range = make("input", { type: "range", min: 0, max: source.rows.length - 1, step: 1, "aria-label": plain(side.symbol) });
  const text = make("input", { type: "text", inputmode: "decimal", autocomplete: "off", "aria-label": `${plain(side.symbol)}, value` });
  range.addEventListener("input", () => page.climb(Number(range.value) - source.row));
  text.addEventListener("change", () => page.typeSecond(text.value));
  fill($("parameters"), make("label", { "data-name": side.name }, make("span", {}, nodes(side.symbol)), range, text));
  $("parameters").hidden = false;
};
