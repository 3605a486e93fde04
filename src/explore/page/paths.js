// Sample paths over the joint density of a live page: where they start, what the server makes of them, and how they are drawn.

/** Colours of paths, all of them light: a dark line beneath sets them off from densities of any colour. */
const PATH_COLOURS = ["#ff8a65", "#7fe3ff", "#ffb3f1", "#ffffff", "#cdbbff", "#ffb04d", "#a5ff8f", "#ffe066"];
/** Length of a path, in turns: what an eye can follow. */
const TURNS = 6;
/** Paths that are drawn at most, and that are asked for at once. */
const MOST_PATHS = 100;
const PATHS_A_REQUEST = 8;

class SamplePaths {
  constructor(page) {
    Object.assign(this, { page, on: false, starts: [], lines: [], key: "", told: null, asking: false, resting: null });
  }

  /** Why no path can be drawn over a watched density; nothing where one can. */
  hindrance(k) {
    const observable = this.page.source.observables[k];
    const { dimension } = this.page.scene;
    return observable.axes.every((axis) => axis < dimension) ? "" : `A path starts at a state, which no place of ${plain(observable.title)} is.`;
  }

  toggle(on = !this.on) {
    this.on = on;
    this.page.later();
  }

  /** Starts a path at a place of the shown joint density. */
  startAt(x, y) {
    const { page } = this;
    const k = page.k.joint;
    if (k === undefined || !page.frame?.densities[k]) return;
    const { edges, axes } = page.source.observables[k];
    const at = [x, y].map((value) => Number(value.toPrecision(4)));
    if (at.some((value, side) => !(value >= edges[side][0] && value <= edges[side][edges[side].length - 1]))) return;
    const full = this.starts.length >= MOST_PATHS ? `${MOST_PATHS} paths are drawn. Clear them to start others.` : "";
    $("refused").textContent = full || this.hindrance(k);
    if ($("refused").textContent) return;
    this.starts.push({ axes, at });
    this.follow();
    page.later();
  }

  /** Starts one without a mouse: at the mean, or at the section's place. */
  startHere() {
    const { page } = this;
    const axes = page.source.observables[page.k.joint]?.axes;
    const mean = axes?.map((axis) => page.frame?.moments[axis]?.[0]);
    if (mean?.every(Number.isFinite)) this.startAt(mean[0], page.section ?? mean[1]);
  }

  clear() {
    Object.assign(this, { starts: [], lines: [], told: null });
    this.page.later();
  }

  /** The values to which lines belong. */
  get here() {
    return JSON.stringify(this.page.good ?? null);
  }

  /** Follows the paths anew as soon as the sliders rest. */
  rest() {
    clearTimeout(this.resting);
    if (this.starts.length) this.resting = setTimeout(() => this.follow(), 120);
  }

  /** The state where a path starts: its place, and the means of the shown density along the other axes. */
  stateOf({ axes, at }) {
    const state = this.page.frame.moments.slice(0, this.page.scene.dimension).map(([mean]) => mean);
    axes.forEach((axis, side) => { state[axis] = at[side]; });
    return state;
  }

  /** Asks for what is not there yet, a few paths at a time and one request after another. */
  async follow() {
    if (this.asking) return;
    this.asking = true;
    const { page } = this;
    while (this.lacks()) {
      const { here, starts } = this;
      if (here !== this.key) Object.assign(this, { key: here, lines: [] });
      const first = this.lines.length;
      const asked = starts.slice(first, first + PATHS_A_REQUEST).map((start, i) => ({ state: this.stateOf(start), seed: first + i + 1 }));
      const body = { values: { ...page.good }, starts: asked, turns: TURNS };
      let answer = null;
      try {
        answer = await page.source.ask("paths", "paths", body);
      } catch (error) {
        page.refuse(error);
      }
      // They may have been cleared meanwhile, or the sliders may have moved.
      if (starts !== this.starts || here !== this.here) continue;
      this.told = answer;
      // What was refused is not asked for again at these values.
      asked.forEach((_, i) => this.lines.push(answer ? this.line(answer, answer.paths[i]) : null));
      page.later();
    }
    this.asking = false;
  }

  lacks() {
    const { frame } = this.page;
    return Boolean(frame?.moments.length) && this.starts.length > (this.here === this.key ? this.lines.length : 0);
  }

  line({ dimension }, { states, ran_away: ranAway }) {
    return { numbers: new Float32Array(fromBase64(states).buffer), dimension, ranAway, places: {} };
  }

  /** What is drawn over a joint density: of every path its number, colour and places. */
  over(k) {
    const { axes } = this.page.source.observables[k];
    if (this.hindrance(k) || this.key !== this.here) return [];
    return this.lines.flatMap((line, i) => {
      if (!line) return [];
      const places = line.places[axes] ??= this.along(line, axes);
      return [{ number: i + 1, colour: PATH_COLOURS[i % PATH_COLOURS.length], places }];
    });
  }

  along({ numbers, dimension }, axes) {
    return Array.from({ length: numbers.length / dimension }, (_, n) => axes.map((axis) => numbers[n * dimension + axis]));
  }

  /** What the controls say. */
  write() {
    const { page, starts, lines, told } = this;
    const hindrance = page.k.joint === undefined ? "" : this.hindrance(page.k.joint);
    $("paths").setAttribute("aria-pressed", String(this.on));
    $("paths").disabled = hindrance !== "";
    $("path-start").hidden = !this.on;
    $("path-start").textContent = page.section === null ? "Start at the mean" : "Start on the section";
    $("path-clear").hidden = !this.on && starts.length === 0;
    $("path-clear").disabled = starts.length === 0;
    const ran = lines.flatMap((line, i) => (line?.ranAway ? [i + 1] : []));
    const words = hindrance || (starts.length === 0 ? (this.on ? "Click the joint density to start a path; drag to lay a section." : "")
      : this.key !== this.here || !told ? `${starts.length === 1 ? "A path is" : "Paths are"} being followed.`
        : `${starts.length === 1 ? "1 path" : `${starts.length} paths`} of ${plainNumber(told.time, 3)} units of time, in ${told.steps} steps.${ran.length ? ` Ran away: ${ran.join(", ")}.` : ""}`);
    if ($("path-says").textContent !== words) $("path-says").textContent = words;
  }

  /** Places for the address, and back. What is no place is left out. */
  get address() {
    return this.starts.map(({ axes, at }) => [...axes, ...at].join(" ")).join(",");
  }

  restore(text) {
    const { source, scene } = this.page;
    const known = (axes) => source.observables.some((one) => one.joint && one.axes.every((axis, side) => axis === axes[side] && axis < scene.dimension));
    const places = (text ?? "").split(",").map((four) => four.split(" ").map((number) => (number === "" ? NaN : Number(number))));
    const sound = places.filter((four) => four.length === 4 && four.every(Number.isFinite) && known(four));
    if (this.address === sound.map((four) => four.join(" ")).join(",")) return;
    this.clear();
    this.starts = sound.slice(0, MOST_PATHS).map(([i, j, ...at]) => ({ axes: [i, j], at }));
  }
}

/** Paths over a plot, numbered where they start. */
const drawPaths = (plot, paths, size) => plot.clipped(() => {
  for (const { colour, places } of paths) {
    const points = places.map((place) => plot.place(place));
    plot.pen.line(points, { colour: "#000", width: 2.8, alpha: 0.6 });
    plot.pen.line(points, { colour, width: 1.4 });
  }
  for (const { number: path, colour, places } of paths) {
    const [x, y] = plot.place(places[0]);
    const r = 0.32 * size;
    plot.pen.area([[x - r, y], [x, y - r], [x + r, y], [x, y + r]], { colour, edge: "#000", width: 1.5 });
    plot.pen.text(x + 1.6 * r, y - r, String(path), { colour, size, align: "left", halo: "#000" });
  }
});

/** The controls of sample paths. */
const connectPaths = (page) => {
  $("path-row").hidden = page.k.joint === undefined;
  $("path-key").hidden = $("path-key").nextElementSibling.hidden = page.k.joint === undefined;
  $("paths").addEventListener("click", () => page.paths.toggle());
  $("path-start").addEventListener("click", () => page.paths.startHere());
  $("path-clear").addEventListener("click", () => page.paths.clear());
};

