// The live page: every value is solved when it is asked for. One request is on its way at a time; what was asked for meanwhile is asked
// for next, so that what is shown is never older than what was shown before.

/** Solved values along the sweep that fill the diagram. */
const FILL = 61;
/** Milliseconds after which a solve counts as slow: it is then previewed on fewer cells while a slider moves. */
const SLOW = 60;
/** Milliseconds after which a newer request cancels the one on its way. */
const PATIENCE = 400;

class LivePage extends Page {
  constructor(scene, source) {
    super(scene, source);
    this.swept = scene.swept.name;
    this.initial = Object.fromEntries(scene.parameters.map(({ name, value }) => [name, value]));
    this.initial[this.swept] = 0.5 * (scene.swept.from + scene.swept.to);
    Object.assign(this, { values: { ...this.initial }, moving: this.swept, flying: null, wanted: 0, resting: null, filled: null });
    this.cost = 0;
    this.paths = new SamplePaths(this);
  }

  /** The part of an axis where what is shown, pinned or along the sweep is worth looking at. */
  windowOf(k, axis) {
    const shown = [this.frame, this.pinned, ...this.source.frames].filter((frame) => frame?.densities[k]?.values);
    const parts = shown.map((frame) => windowOfFrame(frame, k, axis));
    const edges = this.source.observables[k].edges[axis];
    if (!parts.length) return [edges[0], edges[edges.length - 1]];
    return [Math.min(...parts.map((part) => part[0])), Math.max(...parts.map((part) => part[1]))];
  }

  go(value) {
    this.move(this.swept, value);
  }

  home() {
    this.go(this.scene.swept.from);
  }

  end() {
    this.go(this.scene.swept.to);
  }

  step(by) {
    const { from, to } = this.scene.swept;
    this.go(Number(clamp(this.values[this.swept] + (by * (to - from)) / 200, ...this.range).toPrecision(12)));
  }

  slide(place) {
    const { from, to } = this.scene.swept;
    this.go(Number((from + ((to - from) * place) / 400).toPrecision(12)));
  }

  /** To a place of the plane. */
  goPlane([first, second]) {
    this.values[this.scene.plane.sides[1].name] = second;
    this.go(first);
  }

  climb(by) {
    const { name, from, to } = this.scene.plane.sides[1];
    this.move(name, Number(clamp(this.values[name] + (by * (to - from)) / 200, from, to).toPrecision(12)));
  }

  jump(direction) {
    const here = this.values[this.swept];
    const beyond = this.scene.labels.map(({ value }) => value).filter((value) => (value - here) * direction > 1e-12 * (this.range[1] - this.range[0]));
    if (beyond.length) this.go(direction > 0 ? Math.min(...beyond) : Math.max(...beyond));
  }

  /** Sets a parameter and asks for the density. */
  move(name, value) {
    this.values[name] = value;
    this.moving = name;
    this.wanted++;
    $("refused").textContent = "";
    this.writeControls();
    clearTimeout(this.resting);
    if (!this.flying) this.send(true);
    else setTimeout(() => { if (this.flying && performance.now() - this.flying.began > PATIENCE) this.send(true); }, PATIENCE);
  }

  /** Asks for what is wanted now; `moves`: a coarse preview will do while it moves and solves are slow. */
  async send(moves) {
    const values = { ...this.values };
    const flight = { wanted: this.wanted, began: performance.now() };
    this.flying = flight;
    const preview = moves && this.cost > SLOW;
    try {
      const answer = await this.source.ask("solve", "shown", { moving: this.moving, values, preview });
      if (answer && flight === this.flying) {
        this.good = values;
        this.arrive(answer, values[this.swept], preview);
      }
    } catch (error) {
      if (flight === this.flying) this.takeBack(error);
    }
    if (flight !== this.flying) return;
    this.flying = null;
    if (this.wanted !== flight.wanted) this.send(true);
    else if (preview) this.resting = setTimeout(() => { if (!this.flying) this.send(false); }, 120);
    else this.resting = setTimeout(() => this.fill(), 150);
  }

  arrive(answer, value, preview) {
    // Too few cells may hold no density where more do: that is not worth showing.
    if (preview && answer.frame.found.length === 0) return;
    // A map belongs to the parameters that do not span its plane.
    if (this.mapped && this.mapped !== this.beside()) {
      this.mapped = this.scene.plane.found = null;
      this.redrawPlane();
    }
    this.frame = this.source.frame(answer, value);
    this.frame.preview = preview;
    if (this.scene.plane) this.frame.second = this.good[this.scene.plane.sides[1].name];
    if (!preview) this.cost = answer.milliseconds;
    this.remember(this.frame);
    this.paths.rest();
    this.later();
  }

  /** Values that were refused give way to those that are shown, or to those that the page began with. */
  takeBack(error) {
    this.refuse(error);
    const values = this.good ?? this.initial;
    const same = Object.keys(values).every((name) => values[name] === this.values[name]);
    this.values = { ...values };
    this.writeControls();
    if (!this.good && !same) this.wanted++;
  }

  refuse(error) {
    if (!(error instanceof Refused)) throw error;
    $("refused").textContent = error.message;
  }

  remember(frame) {
    frame.densities.forEach((density, k) => {
      if (density.values) this.source.tops[k] = Math.max(this.source.tops[k], largest(density.values));
    });
  }

  /** What the diagram belongs to: the parameters that are not swept. */
  get others() {
    return JSON.stringify({ ...this.values, [this.swept]: null });
  }

  /** Solves along the sweep to fill the diagram, while nothing else is asked for. */
  async fill() {
    const others = this.others;
    if (this.filled === others || this.singles.length === 0) return;
    this.filled = others;
    this.forget();
    const { from, to } = this.scene.swept;
    const values = { ...this.values };
    for (let i = 0; i < FILL && this.filled === others && this.others === others; i++) {
      while (this.flying) await new Promise((resolve) => setTimeout(resolve, 20));
      const value = Number((from + ((to - from) * i) / (FILL - 1)).toPrecision(12));
      const body = { moving: this.swept, values: { ...values, [this.swept]: value }, marginals_only: true };
      const answer = await this.source.ask("solve", "fill", body).catch(() => null);
      if (this.filled !== others) return;
      if (answer) this.insert(this.source.frame(answer, value));
      if (i % 6 === 5 || i === FILL - 1) this.redrawDiagram();
    }
    // What was left behind is filled when the sliders rest again.
    if (this.others !== others && this.filled === others) this.filled = null;
  }

  /** Forgets the diagram and what was located on it: it belonged to other parameters. */
  forget() {
    this.source.frames = [];
    this.source.tops = this.source.tops.map(() => 0);
    if (this.frame) this.remember(this.frame);
    this.scene.labels = [];
    this.tabulate();
    this.redrawDiagram();
  }

  insert(frame) {
    const at = this.source.frames.findIndex((one) => one.value >= frame.value);
    const frames = this.source.frames;
    if (at < 0) frames.push(frame);
    else frames.splice(at, frames[at].value === frame.value ? 1 : 0, frame);
    this.remember(frame);
  }

  redrawDiagram() {
    delete this.drawn.diagram;
    delete this.drawn.numbers;
    this.later();
  }

  /** Narrows the change of words that lies nearest to the cursor. */
  async locate() {
    const { frames } = this.source;
    const here = this.values[this.swept];
    const words = (frame) => frame.found.map((found) => found.words).join();
    const pairs = frames.slice(1).map((frame, i) => [frames[i], frame]).filter(([a, b]) => words(a) !== words(b));
    const far = ([a, b]) => Math.max(a.value - here, here - b.value, 0);
    const nearest = pairs.sort((one, other) => far(one) - far(other))[0];
    if (!nearest) {
      $("refused").textContent = "Nothing changes between the values that are solved so far.";
      return;
    }
    const others = this.others;
    const button = $("locate");
    button.disabled = true;
    button.textContent = "Locating…";
    try {
      const body = { values: { ...this.values }, from: nearest[0].value, to: nearest[1].value };
      const answer = await this.source.ask("locate", "locate", body);
      if (answer && this.others === others) this.add(answer.labels);
    } catch (error) {
      this.refuse(error);
    }
    button.disabled = false;
    button.textContent = "Locate here";
  }

  /** Makes the map of the plane, or gives up the one in the making. */
  async map() {
    const { plane } = this.scene;
    const lane = `${this.source.client}-map`;
    const values = { ...this.values };
    if (this.mapping) {
      await this.source.ask("map", "map", { values, stop: true }).catch(() => {});
      return;
    }
    this.mapping = true;
    const watch = setInterval(async () => {
      const told = await this.source.ask("map-progress", null, { lane }).catch(() => null);
      if (told && this.mapping) $("map").textContent = `Stop: ${told.nodes} of ${told.wanted} nodes${told.points ? `, ${told.points} points of curves` : ""}`;
    }, 500);
    $("map").textContent = "Stop";
    try {
      const found = await this.source.ask("map", "map", { values });
      if (found) {
        plane.found = found;
        this.mapped = this.beside();
        this.redrawPlane();
      }
    } catch (error) {
      this.refuse(error);
    }
    clearInterval(watch);
    this.mapping = false;
    $("map").textContent = "Map the plane";
  }

  /** The parameters that do not span the plane. */
  beside() {
    const spanning = this.scene.plane.sides.map(({ name }) => name);
    return JSON.stringify(Object.entries(this.values).filter(([name]) => !spanning.includes(name)));
  }

  redrawPlane() {
    delete this.drawn.plane;
    this.tabulate();
    this.later();
  }

  /** Adds located changes and numbers all along the sweep; one that was there within its error is replaced. */
  add(labels) {
    const same = (a) => (b) => a.observable === b.observable && Math.abs(a.value - b.value) <= Math.max(a.upper - a.lower, b.upper - b.lower);
    const kept = this.scene.labels.filter((old) => !labels.some(same(old)));
    this.scene.labels = [...kept, ...labels].sort((a, b) => a.value - b.value).map((label, i) => ({ ...label, label: `PB${i + 1}` }));
    if (!labels.length) $("refused").textContent = "No change of topology was located there.";
    this.tabulate();
    this.redrawDiagram();
  }

  play(on = this.timer === null) {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = on ? setInterval(() => {
      if (this.values[this.swept] >= this.range[1]) this.play(false);
      else if (!this.flying) this.step(1);
    }, 60) : null;
    if (on && this.values[this.swept] >= this.range[1]) this.home();
    this.writePlay(on);
  }

  pin(frame = this.pinned ? null : this.frame) {
    this.pinnedValues = frame ? { ...this.values } : null;
    super.pin(frame);
  }

  type(text) {
    const value = this.readNumber(text);
    if (value !== null) this.go(value);
    return value !== null;
  }

  readNumber(text) {
    const value = Number(text.trim().replace("−", "-").replace(",", "."));
    const sound = text.trim() !== "" && Number.isFinite(value);
    $("refused").textContent = sound ? "" : `“${text}” is not a number.`;
    return sound ? value : null;
  }

  async copySweepFile() {
    const { [this.swept]: _, ...values } = this.values;
    try {
      await copy(await this.source.ask("sweep-file", null, { values }));
      flash("toml", "Copied");
    } catch (error) {
      this.refuse(error);
    }
  }

  writeControls() {
    const { from, to } = this.scene.swept;
    const slide = $("slide");
    slide.max = "400";
    slide.value = String(Math.round((400 * (this.values[this.swept] - from)) / (to - from)));
    if (document.activeElement !== $("typed")) $("typed").value = String(this.values[this.swept]);
    for (const field of document.querySelectorAll("#parameters label")) {
      const value = this.values[field.dataset.name];
      const [range, text] = field.querySelectorAll("input");
      if (document.activeElement !== range) {
        if (value < Number(range.min) || value > Number(range.max)) setRange(range, this.scene.parameters.find(({ name }) => name === field.dataset.name), value);
        range.value = String(value);
      }
      if (document.activeElement !== text) text.value = String(value);
    }
  }

  write() {
    super.write();
    this.paths.write();
    document.documentElement.dataset.solved = `${this.frame.value} ${this.frame.preview ? "preview" : "full"}`;
  }

  state() {
    const changed = Object.entries(this.values).filter(([name, value]) => name === this.swept || value !== this.initial[name]);
    const pinned = this.pinnedValues && Object.entries(this.pinnedValues).map(([name, value]) => `${name}:${value}`).join(" ");
    return { ...super.state(), pin: pinned, paths: this.paths.address, ...Object.fromEntries(changed) };
  }

  restorePlace(state, numeric) {
    for (const name of Object.keys(this.values)) this.values[name] = numeric(state[name]) ?? this.initial[name];
    this.paths.restore(state.paths);
    const pairs = (state.pin ?? "").split(" ").map((pair) => pair.split(":")).filter(([name, value]) => name in this.values && numeric(value) !== null);
    if (pairs.length) {
      const values = { ...this.initial, ...Object.fromEntries(pairs.map(([name, value]) => [name, Number(value)])) };
      this.source.ask("solve", "pinned", { moving: this.swept, values }).then((answer) => {
        if (!answer) return;
        const frame = this.source.frame(answer, values[this.swept]);
        if (this.scene.plane) frame.second = values[this.scene.plane.sides[1].name];
        Page.prototype.pin.call(this, frame);
        this.pinnedValues = values;
      }).catch(() => {});
    }
    this.move(this.swept, this.values[this.swept]);
  }
}

/** The ends of a parameter's slider around a value, within what the model allows. */
const setRange = (input, { range }, value) => {
  const reach = value === 0 ? 1 : 2 * Math.abs(value);
  const low = range === "any" ? value - reach : range === "positive" ? value / 20 : Math.max(0, value - reach);
  const high = value + reach;
  input.min = String(low);
  input.max = String(high);
  input.step = String((high - low) / 400);
};

/** So few sliders always stand open; more of them where the window is so many pixels high. */
const FEW = 4;
const HIGH = 800;

/** A slider and a typed value for every parameter that is not swept. */
const buildParameters = (page) => {
  const { scene } = page;
  const fields = scene.parameters.filter(({ name }) => name !== page.swept).map((parameter) => {
    const range = make("input", { type: "range", "aria-label": parameter.meaning });
    const side = scene.plane?.sides.find(({ name }) => name === parameter.name);
    if (side) Object.assign(range, { min: String(side.from), max: String(side.to), step: String((side.to - side.from) / 400) });
    else setRange(range, parameter, parameter.value);
    range.value = String(parameter.value);
    const text = make("input", { type: "text", inputmode: "decimal", autocomplete: "off", "aria-label": `${parameter.meaning}, value` });
    range.addEventListener("input", () => page.move(parameter.name, Number(Number(range.value).toPrecision(6))));
    text.addEventListener("change", () => {
      const value = page.readNumber(text.value);
      if (value !== null) page.move(parameter.name, value);
    });
    return make("label", { "data-name": parameter.name, title: `${parameter.meaning}: ${parameter.allowed}` },
      make("span", {}, nodes(parameter.symbol)), range, text);
  });
  fill($("parameters"), fields);
  $("others").hidden = fields.length === 0;
  // Many sliders would leave a low window no room for what they move.
  $("others").open = fields.length <= FEW || window.innerHeight >= HIGH;
  $("locate").hidden = false;
  $("locate").addEventListener("click", () => page.locate());
  $("map").hidden = !scene.plane;
  $("map").addEventListener("click", () => page.map());
};

