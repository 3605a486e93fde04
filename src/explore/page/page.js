// The page itself: what is shown, what the controls do, and when it is drawn.

const $ = (id) => document.getElementById(id);

class Page {
  constructor(scene, source) {
    Object.assign(this, { scene, source, frame: null, pinned: null, timer: null, drawn: {}, windows: {}, waiting: false });
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
      options: { ...this.options, difference: this.options.difference && this.pinned !== null }, section: this.section, k,
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
    if (this.k.joint !== undefined) this.paint("joint-canvas", drawJoint, this.k.joint);
    for (const k of this.singles) this.paint(`marginal-${k}`, drawMarginal, k);
    const hasSection = this.section !== null && this.k.joint !== undefined;
    $("section-figure").hidden = !hasSection;
    if (hasSection) this.paint("section-canvas", drawSection, this.k.joint);
    if (this.k.diagram !== undefined) {
      if (!this.drawn.diagram) this.paint("diagram-canvas", drawDiagram, this.k.diagram);
      this.paintCursor();
    }
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
    if (id === "section-canvas") return `Section of ${plain(one.title)} at ${at}`;
    return `${plain(one.title)} at ${at}: ${countWords(this.frame.found[k])}`;
  }

  paintCursor() {
    const canvas = $("cursor-canvas");
    const { width, height } = canvas.parentElement.getBoundingClientRect();
    const plot = this.drawn.diagram;
    if (!plot || width < 20) return;
    const pen = new CanvasPen(canvas, width, height, window.devicePixelRatio || 1);
    const over = new Plot(pen, plot.rect, plot.ranges.x, plot.ranges.y, this.theme, this.size);
    drawCursor(over, this.view(this.k.diagram));
    canvas.setAttribute("aria-label", `Cursor along ${plain(this.scene.swept.symbol)}`);
    canvas.setAttribute("aria-valuemin", this.range[0]);
    canvas.setAttribute("aria-valuemax", this.range[1]);
    canvas.setAttribute("aria-valuenow", this.frame.value);
    canvas.setAttribute("aria-valuetext", sentence(this.scene, this.source, this.frame));
  }

  /** Where the shown state lies in the plane, over what does not change with it. */
  paintPlace() {
    const canvas = $("place-canvas");
    const { width, height } = canvas.parentElement.getBoundingClientRect();
    const plot = this.drawn.plane;
    if (!plot || width < 20) return;
    const pen = new CanvasPen(canvas, width, height, window.devicePixelRatio || 1);
    drawPlaneCursor(new Plot(pen, plot.rect, plot.ranges.x, plot.ranges.y, this.theme, this.size), this.view(this.k.plane));
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
    for (const [panel, all] of [["joint", this.joints], ["diagram", this.singles], ["plane", source.observables.map((_, k) => k)]]) {
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

  /** One panel as SVG, PNG or CSV. */
  async export(panel, format) {
    const k = panel === "diagram" || panel === "plane" ? this.k[panel] : panel === "joint" || panel === "section" ? this.k.joint : Number(panel.slice(9));
    const drawing = { joint: drawJoint, diagram: drawDiagram, section: drawSection, plane: drawPlane }[panel] ?? drawMarginal;
    const canvas = $(panel.startsWith("marginal") ? panel : `${panel}-canvas`);
    const { width, height } = canvas.parentElement.getBoundingClientRect();
    const observable = this.source.observables[k];
    const at = panel === "diagram" || panel === "plane" ? "" : `_${this.scene.swept.name}_${this.frame.value}`;
    const name = `${panel.replace(/-\d+$/, "")}_${observable.name}${at}`;
    if (format === "csv") {
      const density = this.frame.densities[k];
      if (panel === "plane") save(`${name}.csv`, "text/csv", planeCsv(this.scene));
      else if (panel === "diagram") save(`${name}.csv`, "text/csv", featuresCsv(this.scene, this.source, k));
      else if (density) save(`${name}.csv`, "text/csv", densityCsv(this.scene, observable, density));
    } else if (format === "svg") {
      const pen = new SvgPen(width, height, this.theme.paper);
      drawing(pen, width, height, this.view(k), this.size);
      save(`${name}.svg`, "image/svg+xml", pen.finish());
    } else {
      const sheet = document.createElement("canvas");
      const pen = new CanvasPen(sheet, width, height, 3);
      pen.area([[0, 0], [width, 0], [width, height], [0, height]], { colour: this.theme.paper });
      drawing(pen, width, height, this.view(k), this.size);
      sheet.toBlob((blob) => blob && save(`${name}.png`, "image/png", blob));
    }
  }
}

/** Buttons that save a panel. */
const exportButtons = (page, panel, name) => ["SVG", "PNG", "CSV"].map((format) => make("button", {
  type: "button", "aria-label": `Save ${name} as ${format}`, onclick: () => page.export(panel, format.toLowerCase()),
}, format));

/** What is swept, and what is held. */
const subtitle = (scene) => {
  const { swept, parameters } = scene;
  // Of a live page the others have their sliders.
  const second = scene.plane?.sides[1].name;
  const held = parameters.filter(({ name, value }) => value !== null && name !== second && !scene.live)
    .flatMap(({ symbol, value }) => [", ", ...nodes(symbol), ` = ${plainNumber(value, 6)}`]).slice(1);
  const ranges = (scene.plane?.sides ?? [swept]).flatMap(({ symbol, from, to }) =>
    [", ", ...nodes(symbol), ` from ${plainNumber(from, 6)} to ${plainNumber(to, 6)}`]).slice(1);
  return [...ranges, held.length ? "; " : "", ...held];
};

/** The parts of the page that depend on what is watched. */
const build = (page) => {
  const { scene, source } = page;
  $("title").textContent = scene.title;
  fill($("model"), subtitle(scene));
  fill($("swept"), nodes(scene.swept.symbol));
  fill($("made"), `Made by ${scene.program}. ${source.note ?? ""}`);
  const every = source.observables.map((_, k) => k);
  for (const [panel, all] of [["joint", page.joints], ["diagram", page.singles], ["plane", every]]) {
    fill($(`${panel}-choice`), all.map((k) => make("option", { value: k }, plain(source.observables[k].title))));
    $(`${panel}-choice`).hidden = all.length < 2;
    if (panel !== "plane") $("panels").classList.toggle(panel === "joint" ? "no-joint" : "no-marginals", all.length === 0);
  }
  if (scene.plane) buildPlane(scene);
  const figures = page.singles.map((k) => {
    const title = source.observables[k].title;
    return make("figure", { "aria-label": `Marginal ${plain(title)}` },
      make("div", { class: "head" }, make("h2", {}, nodes(title)),
        make("span", { class: "exports" }, exportButtons(page, `marginal-${k}`, plain(title)))),
      make("div", { class: "drawing" }, make("canvas", { id: `marginal-${k}`, role: "img" })));
  });
  const caption = make("p", { class: "hint", id: "bands" });
  fill($("marginals"), figures, caption);
  for (const place of document.querySelectorAll(".exports[data-of]")) {
    fill(place, exportButtons(page, place.dataset.of, place.dataset.of === "joint" ? "the joint density" : `the ${place.dataset.of}`));
  }
  if (page.k.joint !== undefined) fill($("section-axis"), nodes(source.observables[page.k.joint].symbols[1]));
  page.tabulate();
  fill($("facts"), facts(scene));
};

/** The panel of the plane, and what is called otherwise where there is one. */
const buildPlane = (scene) => {
  $("plane").hidden = false;
  $("panels").classList.add("has-plane");
  const [x, y] = scene.plane.sides.map(({ symbol }) => nodes(symbol));
  fill($("plane-name"), "Plane of ", x, " and ", y);
  $("changes-name").textContent = "Curves and points";
  $("up-keys").hidden = $("up-keys").nextElementSibling.hidden = false;
};

/** What the controls do. */
const connect = (page) => {
  const on = (id, event, act) => $(id).addEventListener(event, act);
  on("slide", "input", () => page.slide(Number($("slide").value)));
  on("previous", "click", () => page.step(-1));
  on("next", "click", () => page.step(1));
  on("play", "click", () => page.play());
  on("back", "click", () => page.jump(-1));
  on("forth", "click", () => page.jump(1));
  on("pin", "click", () => page.pin());
  for (const name of ["log", "contours", "marks", "difference"]) on(name, "change", () => page.set(name, $(name).checked));
  on("lock", "change", () => page.lock());
  on("typed", "change", () => page.type($("typed").value));
  on("typed", "blur", () => { if (page.frame && !$("refused").textContent) page.writeControls(); });
  on("section", "change", () => setSection(page, $("section").value.trim() === "" ? null : Number($("section").value.replace("−", "-"))));
  on("joint-choice", "change", () => { page.k.joint = Number($("joint-choice").value); page.options.lock = null; page.later(); });
  on("diagram-choice", "change", () => { page.k.diagram = Number($("diagram-choice").value); delete page.drawn.diagram; page.later(); });
  on("plane-choice", "change", () => { page.k.plane = Number($("plane-choice").value); delete page.drawn.plane; page.later(); });
  on("theme", "change", () => setTheme(page, $("theme").value));
  on("link", "click", () => copy(location.href).then(() => flash("link", "Copied")));
  on("toml", "click", () => page.copySweepFile());
  on("print", "click", () => window.print());
  on("help", "click", () => $("keys").showModal());
  drag($("cursor-canvas"), (x) => page.drawn.diagram && page.go(clamp(page.drawn.diagram.x.from(x), ...page.range)));
  drag($("place-canvas"), (x, y) => {
    const plot = page.drawn.plane;
    if (!plot) return;
    const place = [clamp(plot.x.from(x), ...plot.ranges.x), clamp(plot.y.from(y), ...plot.ranges.y)];
    page.goPlane(place.map((value) => Number(value.toPrecision(5))));
  });
  drag($("joint-canvas"), (_, y) => page.drawn.joint && setSection(page, Number(page.drawn.joint.y.from(y).toPrecision(4))));
  document.addEventListener("keydown", (event) => press(page, event));
  const redraw = () => { page.theme = themeColours(); page.drawn = {}; page.later(); };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  window.addEventListener("beforeprint", () => { redraw(); page.draw(); });
  window.addEventListener("hashchange", () => page.restore(readAddress()));
  new ResizeObserver(redraw).observe($("panels"));
};

const setSection = (page, value) => {
  page.section = value !== null && Number.isFinite(value) ? value : null;
  $("section").value = page.section ?? "";
  page.later();
};

const setTheme = (page, theme) => {
  if (theme) document.documentElement.dataset.theme = theme;
  else delete document.documentElement.dataset.theme;
  page.theme = themeColours();
  page.drawn = {};
  page.later();
};

const flash = (id, word) => {
  const before = $(id).textContent;
  if (before === word) return;
  $(id).textContent = word;
  setTimeout(() => { $(id).textContent = before; }, 1200);
};

/** Calls `act` with the place of the pointer in the canvas while it is pressed. */
const drag = (canvas, act) => {
  const place = (event) => {
    const { left, top } = canvas.getBoundingClientRect();
    act(event.clientX - left, event.clientY - top);
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    place(event);
  });
  canvas.addEventListener("pointermove", (event) => { if (canvas.hasPointerCapture(event.pointerId)) place(event); });
};

/** Keys; what is typed into a field, and what a control does with a key itself, is left alone. */
const press = (page, event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || $("keys").open) return;
  const { target } = event;
  const writes = target.matches("input[type=text], select, textarea");
  const acts = target.matches("button, summary, input[type=checkbox], a");
  if (writes || (acts && [" ", "Enter"].includes(event.key))) return;
  const actions = {
    ArrowLeft: () => page.step(-1), ArrowRight: () => page.step(1), PageDown: () => page.step(-10), PageUp: () => page.step(10),
    Home: () => page.home(), End: () => page.end(), b: () => page.jump(-1), n: () => page.jump(1), " ": () => page.play(),
    p: () => page.pin(), d: () => page.pinned && page.set("difference"), l: () => page.set("log"), k: () => page.lock(),
    c: () => page.set("contours"), m: () => page.set("marks"), "?": () => $("keys").showModal(),
  };
  // Up and down belong to the page's scrolling, except on the two sliders.
  if (target === $("cursor-canvas") || target === $("slide")) {
    actions.ArrowUp = actions.ArrowRight;
    actions.ArrowDown = actions.ArrowLeft;
  }
  else if (page.scene.plane) {
    actions.ArrowUp = () => page.climb(1);
    actions.ArrowDown = () => page.climb(-1);
  }
  // The slider of another parameter does with arrows what sliders do.
  if (target.closest("#parameters") && event.key.startsWith("Arrow")) return;
  const act = actions[event.key];
  if (!act) return;
  event.preventDefault();
  act();
};

