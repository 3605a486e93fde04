// The page itself: what is shown, and when it is drawn.

const $ = (id) => document.getElementById(id);

/** The name of a field in figures: the components of a current are drawn together. */
const fieldName = ({ name }, { axes }) => {
  const component = axes.map((axis) => axis.name).find((axis) => name.endsWith(`_reactive_current_${axis}`));
  return component === undefined ? name : name.slice(0, -component.length - 1);
};

class Page {
  constructor(scene, source) {
    Object.assign(this, { scene, source, frame: null, pinned: null, paths: null, timer: null, drawn: {}, columns: [], number: null, windows: {}, waiting: false, printing: false });
    this.options = { log: false, lock: null, contours: true, marks: true, difference: false };
    this.section = null;
    this.joints = source.observables.map((one, k) => (one.joint ? k : -1)).filter((k) => k >= 0);
    this.singles = source.observables.map((one, k) => (one.joint ? -1 : k)).filter((k) => k >= 0);
    this.k = { joint: this.joints[0], diagram: this.singles[0], plane: 0 };
    const values = [scene.swept.from, scene.swept.to, ...source.frames.map((frame) => frame.value)];
    this.range = [Math.min(...values), Math.max(...values)];
    this.theme = themeColours();
  }

  /** What the panels see of the page. */
  view(k) {
    return {
      scene: this.scene, source: this.source, frame: this.frame, pinned: this.pinned, theme: this.theme, range: this.range,
      options: { ...this.options, difference: this.options.difference && this.pinned !== null }, section: this.section, k, column: this.columns.length ? Along.column(this) : null,
      paths: (k === this.k.joint && this.paths?.over(k)) || [],
      window: (observable, axis) => this.windowOf(observable, axis),
    };
  }

  /** The part of an axis of a watched density that is worth looking at along the whole sweep. */
  windowOf(k, axis) {
    return this.windows[`${k} ${axis}`] ??= windowOf(this.source, k, axis);
  }

  /** Shows the frame nearest to a value. */
  go(value) {
    this.show(this.source.nearest(value));
  }

  show(index) {
    const frames = this.source.frames;
    this.frame = frames[clamp(index, 0, frames.length - 1)];
    this.later();
  }

  step(by) {
    this.show(this.frame.index + by);
  }

  slide(place) {
    this.show(place);
  }

  home() {
    this.show(0);
  }

  end() {
    this.show(this.source.frames.length - 1);
  }

  /** To the next located change on either side. */
  jump(direction) {
    const values = this.scene.labels.filter(({ kind }) => kind === "bifurcation").map(({ value }) => value);
    const beyond = values.map((value) => this.source.nearest(value)).filter((index) => (index - this.frame.index) * direction > 0);
    if (beyond.length) this.show(direction > 0 ? Math.min(...beyond) : Math.max(...beyond));
  }

  play(on = this.timer === null) {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = null;
    if (on) {
      const last = this.source.frames.length - 1;
      if (this.frame.index === last) this.show(0);
      this.timer = setInterval(() => {
        if (this.frame.index >= last) this.play(false);
        else this.step(1);
      }, Math.max(30, 9000 / (last + 1)));
    }
    this.writePlay(on);
  }

  writePlay(on) {
    $("play").setAttribute("aria-pressed", String(on));
    $("play").textContent = on ? "Stop" : "Play";
    // A list of every value that passes would only be noise to who listens.
    $("says").setAttribute("aria-live", on ? "off" : "polite");
  }

  pin(frame = this.pinned ? null : this.frame) {
    this.pinned = frame;
    $("pin").setAttribute("aria-pressed", String(frame !== null));
    $("pin").textContent = frame ? `Pinned at ${plainNumber(frame.value, 4)}` : "Pin";
    $("difference").disabled = frame === null;
    this.later();
  }

  set(option, value = !this.options[option]) {
    this.options[option] = value;
    $(option).checked = Boolean(value);
    if (option === "log") delete this.drawn.diagram;
    this.later();
  }

  lock(top) {
    const values = this.frame?.densities[this.k.joint]?.values;
    this.options.lock = top === undefined ? (this.options.lock === null && values ? largest(values) : null) : top;
    $("lock").checked = this.options.lock !== null;
    this.later();
  }

  /** Draws before the next picture of the screen, once however much has changed. */
  later() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  draw() {
    if (!this.frame) return;
    const began = performance.now();
    this.write();
    if (this.k.joint !== undefined) {
      $("joint-name").textContent = this.source.observables[this.k.joint].field === null ? "Joint density" : "Over the state";
      this.paint("joint-canvas", drawJoint, this.k.joint);
    }
    for (const k of this.singles) this.paint(`marginal-${k}`, drawMarginal, k);
    const hasSection = this.section !== null && this.k.joint !== undefined;
    $("section-figure").hidden = !hasSection;
    if (hasSection) this.paint("section-canvas", drawSection, this.k.joint);
    if (this.k.diagram !== undefined) {
      if (!this.drawn.diagram) this.paint("diagram-canvas", drawDiagram, this.k.diagram);
      this.paintCursor();
    }
    Along.draw(this);
    if (this.scene.plane) {
      if (!this.drawn.plane) this.paint("plane-canvas", drawPlane, this.k.plane);
      this.paintPlace();
    }
    writeAddress(this.state());
    this.milliseconds = performance.now() - began;
  }

  /** Size of the lettering of the panels, in pixels. */
  get size() {
    return 0.82 * parseFloat(getComputedStyle(document.documentElement).fontSize);
  }

  /** Draws a panel on its canvas and remembers its plot. */
  paint(id, draw, k) {
    const canvas = $(id);
    const { width, height } = canvas.parentElement.getBoundingClientRect();
    if (width < 20 || height < 20) return;
    const pen = new CanvasPen(canvas, width, height, window.devicePixelRatio || 1);
    this.drawn[id.split("-")[0] === "marginal" ? id : id.split("-")[0]] = draw(pen, width, height, this.view(k), this.size);
    canvas.setAttribute("aria-label", this.describe(id, k));
  }

  describe(id, k) {
    const one = this.source.observables[k];
    const at = `${plain(this.scene.swept.symbol)} = ${plainNumber(this.frame.value, 6)}`;
    if (id === "plane-canvas") {
      const [x, y] = this.scene.plane.sides.map(({ symbol }) => plain(symbol));
      return `Plane of ${x} and ${y}, with the regions of ${plain(one.title)}`;
    }
    if (id === "diagram-canvas") return `${plain(one.title)} over ${plain(this.scene.swept.symbol)}, with branches of peaks and valleys`;
    if (id === "numbers-canvas") {
      const column = Along.column(this);
      return `${plain(column.title)} over ${plain(this.scene.swept.symbol)}; ${told(column, column.of(this.frame))} at ${at}`;
    }
    if (id === "section-canvas") return `Section of ${plain(one.title)} at ${at}`;
    const paths = id === "joint-canvas" ? this.paths?.over(k).length : 0;
    return `${plain(one.title)} at ${at}: ${countWords(this.frame.found[k])}${paths ? `; sample paths drawn over it: ${paths}` : ""}`;
  }

  paintCursor() {
    // A printed canvas is opaque: on paper the cursor stands on the diagram itself.
    const canvas = $(this.printing ? "diagram-canvas" : "cursor-canvas");
    const { width, height } = canvas.parentElement.getBoundingClientRect();
    const plot = this.drawn.diagram;
    if (!plot || width < 20) return;
    const pen = new CanvasPen(canvas, width, height, window.devicePixelRatio || 1, this.printing);
    const over = new Plot(pen, plot.rect, plot.ranges.x, plot.ranges.y, this.theme, this.size);
    drawCursor(over, this.view(this.k.diagram));
    if (this.printing) return;
    canvas.setAttribute("aria-label", `Cursor along ${plain(this.scene.swept.symbol)}`);
    canvas.setAttribute("aria-valuemin", this.range[0]);
    canvas.setAttribute("aria-valuemax", this.range[1]);
    canvas.setAttribute("aria-valuenow", this.frame.value);
    canvas.setAttribute("aria-valuetext", sentence(this.scene, this.source, this.frame));
  }

  /** Where the shown state lies in the plane, over what does not change with it. */
  paintPlace() {
    this.paintOver("plane", "place-canvas", drawPlaneCursor);
  }

  /** What changes with the shown state, over the plot of a panel, which does not. */
  paintOver(panel, id, draw) {
    const canvas = $(this.printing ? `${panel}-canvas` : id);
    const { width, height } = canvas.parentElement.getBoundingClientRect();
    const plot = this.drawn[panel];
    if (!plot || width < 20) return;
    const pen = new CanvasPen(canvas, width, height, window.devicePixelRatio || 1, this.printing);
    const over = new Plot(pen, plot.rect, plot.ranges.x, plot.ranges.y, this.theme, this.size);
    over.column = plot.column;
    draw(over, this.view(this.k[panel] ?? 0));
  }

  /** Everything that is said in words. */
  write() {
    const { frame, scene, source } = this;
    const says = sentence(scene, source, frame);
    if ($("says").textContent !== says) $("says").textContent = says;
    $("slide").setAttribute("aria-valuetext", says);
    this.writeControls();
    const band = this.singles.map((k) => source.bandIs(k)).find((words) => words);
    $("bands").textContent = band ? `Bands: ${band}.` : "";
    fill($("words"), reading(this.view(0)));
    for (const row of $("table").querySelectorAll("tr[data-at]")) {
      row.classList.toggle("here", this.isHere(Number(row.dataset.at)));
    }
    $("joint-legend").textContent = this.options.difference && this.pinned
      ? `This density less that pinned at ${plainNumber(this.pinned.value, 6)}; lines at 10 and 50 % of the largest difference.`
      : "Disc: peak. Cross: saddle between peaks. Circle: crater. Double circle: ring. Pale: not certain.";
  }

  /** Whether a value is the one that is shown. */
  isHere(value) {
    return this.frame.index >= 0 && this.source.nearest(value) === this.frame.index;
  }

  writeControls() {
    $("slide").max = String(this.source.frames.length - 1);
    $("slide").value = String(this.frame.index);
    if (document.activeElement !== $("typed")) $("typed").value = String(Number(this.frame.value.toPrecision(9)));
  }

  /** The table of located changes. */
  tabulate() {
    const { scene, source } = this;
    fill($("table"), source.all || (scene.plane && !scene.labels.length) ? [] : changesTable(scene, source, (value) => this.go(value)));
    if (scene.plane) fill($("curves"), planeTable(scene, source, (at) => this.goPlane(at)));
  }

  async copySweepFile() {
    await copy(this.scene.sweep_file);
    flash("toml", "Copied");
  }

  state() {
    const { scene, source, options, k, frame, pinned, section } = this;
    return {
      [scene.swept.name]: frame.value,
      joint: this.joints.length > 1 ? source.observables[k.joint].name : null,
      diagram: this.singles.length > 1 ? source.observables[k.diagram].name : null,
      numbers: this.columns.some(({ name }) => name === this.number) ? this.number : null,
      plane: scene.plane && k.plane ? source.observables[k.plane].name : null,
      log: options.log ? 1 : null, lock: options.lock, contours: options.contours ? null : 0, marks: options.marks ? null : 0,
      pin: pinned?.value, difference: options.difference ? 1 : null, section,
      theme: document.documentElement.dataset.theme ?? null,
    };
  }

  /** Shows what an address says; what it does not say, or says wrongly, stays as it is. */
  restore(state) {
    const { source } = this;
    const numeric = (text) => (text !== undefined && text.trim() !== "" && Number.isFinite(Number(text)) ? Number(text) : null);
    for (const [panel, all] of [["joint", this.joints], ["diagram", this.singles], ["plane", densitiesOf(source).map((_, k) => k)]]) {
      const found = all.find((k) => source.observables[k].name === state[panel]);
      if (found !== undefined) this.k[panel] = found;
    }
    if (state.theme === "light" || state.theme === "dark") document.documentElement.dataset.theme = state.theme;
    $("theme").value = document.documentElement.dataset.theme ?? "";
    this.options.log = state.log === "1";
    this.options.contours = state.contours !== "0";
    this.options.marks = state.marks !== "0";
    this.options.difference = state.difference === "1";
    this.options.lock = numeric(state.lock);
    this.section = numeric(state.section);
    this.number = state.numbers ?? null;
    for (const name of ["log", "contours", "marks", "difference"]) $(name).checked = this.options[name];
    $("lock").checked = this.options.lock !== null;
    $("section").value = this.section ?? "";
    for (const panel of ["joint", "diagram", "plane"]) $(`${panel}-choice`).value = this.k[panel] ?? "";
    this.theme = themeColours();
    this.drawn = {};
    this.restorePlace(state, numeric);
  }

  /** The part of that which says where along the sweep. */
  restorePlace(state, numeric) {
    const { scene, source } = this;
    const pinned = numeric(state.pin);
    this.pin(pinned === null ? null : source.frames[source.nearest(pinned)]);
    this.go(numeric(state[scene.swept.name]) ?? source.frames[Math.floor(source.frames.length / 2)].value);
  }

  /** A typed value: goes there, or says why not. */
  type(text) {
    const value = Number(text.trim().replace("−", "-").replace(",", "."));
    const [from, to] = this.range;
    const name = plain(this.scene.swept.symbol);
    const wrong = text.trim() === "" || !Number.isFinite(value) ? `“${text}” is not a number.`
      : value < from || value > to ? `${name} was swept from ${plainNumber(from, 6)} to ${plainNumber(to, 6)}: ${plainNumber(value, 6)} lies outside.` : "";
    $("refused").textContent = wrong;
    if (!wrong) this.go(value);
    return !wrong;
  }

  /** What a panel shows: its density, what draws it, its size, and its name as that of a file. */
  panel(panel) {
    const isWhole = panel === "diagram" || panel === "plane" || panel === "numbers";
    const k = isWhole ? this.k[panel] ?? 0 : panel === "joint" || panel === "section" ? this.k.joint : Number(panel.slice(9));
    const drawing = { joint: drawJoint, diagram: drawDiagram, section: drawSection, plane: drawPlane, numbers: drawNumbers }[panel] ?? drawMarginal;
    const canvas = $(panel.startsWith("marginal") ? panel : `${panel}-canvas`);
    const { width, height } = canvas.parentElement.getBoundingClientRect();
    const observable = panel === "numbers" ? Along.column(this) : this.source.observables[k];
    const at = isWhole ? "" : `_${this.scene.swept.name}_${this.frame.value}`;
    return { k, drawing, width, height, observable, name: `${panel.replace(/-\d+$/, "")}_${observable.name}${at}`, id: canvas.id };
  }

  /** The numbers of a panel; nothing where it has none. */
  tableOf(panel) {
    const { k, observable } = this.panel(panel);
    const density = this.frame.densities[k];
    if (panel === "plane") return planeCsv(this.scene);
    if (panel === "numbers") return numbersCsv(this.scene, observable, this.source.frames);
    if (panel === "diagram") return featuresCsv(this.scene, this.source, k);
    return density ? densityCsv(this.scene, observable, density) : "";
  }

  /** A panel as PNG, three times as fine as it is shown. */
  pictureOf(panel) {
    const { k, drawing, width, height } = this.panel(panel);
    const sheet = document.createElement("canvas");
    const pen = new CanvasPen(sheet, width, height, 3);
    pen.area([[0, 0], [width, 0], [width, height], [0, height]], { colour: this.theme.paper });
    drawing(pen, width, height, this.view(k), this.size);
    return new Promise((done, fail) => sheet.toBlob((blob) => (blob ? done(blob) : fail(new Error("no picture"))), "image/png"));
  }

  /** What is seen in a panel, of which system: a caption. */
  captionOf(panel) {
    const { k, id } = this.panel(panel);
    const held = this.scene.parameters.filter(({ value }) => value !== null).map(({ symbol, value }) => `${plain(symbol)} = ${plainNumber(value, 6)}`);
    const labels = this.scene.labels.filter(({ kind }) => kind === "bifurcation")
      .map(({ label, value, error }) => `${label} at ${plainNumber(value, 8)} ± ${plainNumber(error, 2)}`);
    const marked = (panel === "diagram" || panel === "numbers") && labels.length ? ` Marked: ${labels.join("; ")}.` : "";
    return `${this.scene.title}. ${this.describe(id, k)}.${marked} Equations: ${this.scene.model.equations.map(({ text }) => text).join("; ")}; `
      + `${held.join(", ")}. Method: ${this.frame.method}. Computed with ${this.scene.program}.`;
  }

  /** The command that draws a figure like a panel; RUN is the folder of the run, which a page that is sent does not know. */
  commandOf(panel) {
    const { observable } = this.panel(panel);
    if (panel === "plane") return `pbif plot RUN --only map_${observable.name}`;
    if (panel === "numbers") return Along.command(observable);
    const own = observable.field === null ? `joint_${observable.name}` : `field_${fieldName(observable, this.scene)}`;
    const kinds = { joint: own, section: `section_${observable.name}`, diagram: `diagram_${observable.name}` };
    const at = panel === "diagram" ? "" : ` --at ${this.frame.value}`;
    return `pbif plot RUN --only ${kinds[panel] ?? "marginals"}${at}`;
  }

  /** Copies what a panel shows: its picture, table, caption, or the command that draws it. */
  async copyPanel(panel, what) {
    if (what === "picture") {
      await navigator.clipboard.write([new ClipboardItem({ "image/png": this.pictureOf(panel) })]);
      return;
    }
    await copy({ table: () => this.tableOf(panel), caption: () => this.captionOf(panel), command: () => this.commandOf(panel) }[what]());
  }

  /** One panel as SVG, PNG or CSV. */
  async export(panel, format) {
    const { k, drawing, width, height, name } = this.panel(panel);
    if (format === "csv") {
      const table = this.tableOf(panel);
      if (table) save(`${name}.csv`, "text/csv", table);
    } else if (format === "svg") {
      const pen = new SvgPen(width, height, this.theme.paper);
      drawing(pen, width, height, this.view(k), this.size);
      save(`${name}.svg`, "image/svg+xml", pen.finish());
    } else {
      save(`${name}.png`, "image/png", await this.pictureOf(panel));
    }
  }
}
