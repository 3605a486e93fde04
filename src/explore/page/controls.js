// The parts of the page that depend on what is watched, and what its controls and keys do.

/** Buttons that save a panel. */
const exportButtons = (page, panel, name) => ["SVG", "PNG", "CSV"].map((format) => make("button", {
  type: "button", "aria-label": `Save ${name} as ${format}`, onclick: () => page.export(panel, format.toLowerCase()),
}, format)).concat(copyChoice(page, panel, name));

/** What can be copied of a panel. */
const copyChoice = (page, panel, name) => {
  const choices = ["picture", "table", "caption", "command"].map((what) => make("option", { value: what }, what));
  const select = make("select", { "aria-label": `Copy of ${name}` }, make("option", { value: "" }, "Copy…"), choices);
  select.addEventListener("change", () => {
    const what = select.value;
    if (!what) return;
    const first = select.options[0];
    page.copyPanel(panel, what).then(() => { first.textContent = "Copied"; }, () => { first.textContent = "Refused"; })
      .finally(() => {
        select.value = "";
        setTimeout(() => { first.textContent = "Copy…"; }, 1200);
      });
  });
  return [select];
};

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
  fill($("equations"), equations(scene));
  // What is wider than the window is moved by keys, too.
  new ResizeObserver(([{ target }]) => {
    if (target.scrollWidth > target.clientWidth) target.tabIndex = 0;
    else target.removeAttribute("tabindex");
  }).observe($("equations"));
  fill($("swept"), nodes(scene.swept.symbol));
  fill($("made"), `Made by ${scene.program}. ${source.note ?? ""}`);
  const every = densitiesOf(source).map((_, k) => k);
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
  on("numbers-choice", "change", () => { page.number = $("numbers-choice").value; delete page.drawn.numbers; page.later(); });
  on("plane-choice", "change", () => { page.k.plane = Number($("plane-choice").value); delete page.drawn.plane; page.later(); });
  on("theme", "change", () => setTheme(page, $("theme").value));
  on("link", "click", () => copy(location.href).then(() => flash("link", "Copied")));
  on("toml", "click", () => page.copySweepFile());
  on("print", "click", () => window.print());
  on("help", "click", () => $("keys").showModal());
  drag($("cursor-canvas"), (x) => page.drawn.diagram && page.go(clamp(page.drawn.diagram.x.from(x), ...page.range)));
  drag($("mark-canvas"), (x) => page.drawn.numbers && page.go(clamp(page.drawn.numbers.x.from(x), ...page.range)));
  drag($("place-canvas"), (x, y) => {
    const plot = page.drawn.plane;
    if (!plot) return;
    const place = [clamp(plot.x.from(x), ...plot.ranges.x), clamp(plot.y.from(y), ...plot.ranges.y)];
    page.goPlane(place.map((value) => Number(value.toPrecision(5))));
  });
  drag($("joint-canvas"), (_, y) => page.drawn.joint && setSection(page, Number(page.drawn.joint.y.from(y).toPrecision(4))), {
    wanted: () => page.paths?.on && page.drawn.joint,
    act: (x, y) => page.paths.startAt(page.drawn.joint.x.from(x), page.drawn.joint.y.from(y)),
  });
  document.addEventListener("keydown", (event) => press(page, event));
  const redraw = () => { page.theme = themeColours(); page.drawn = {}; page.later(); };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  printLight(page);
  window.addEventListener("hashchange", () => page.restore(readAddress()));
  new ResizeObserver(() => { if (!page.printing) redraw(); }).observe($("panels"));
};

/** Paper is white whatever the screen is; what was drawn for its colours comes back afterwards. */
const printLight = (page) => {
  const root = document.documentElement;
  let before;
  const paint = () => { page.theme = themeColours(); page.drawn = {}; page.draw(); };
  window.addEventListener("beforeprint", () => {
    before = root.dataset.theme;
    page.printing = true;
    root.dataset.theme = "light";
    paint();
  });
  window.addEventListener("afterprint", () => {
    if (before === undefined) delete root.dataset.theme;
    else root.dataset.theme = before;
    page.printing = false;
    paint();
  });
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

/** Pixels by which a pointer may move between press and release of a click: fingers are not still. */
const STILL = 6;

/** Calls `act` with the place of the pointer in the canvas while it is pressed; where a `tap` is wanted, a press without a move is one, and only a move is a drag. */
const drag = (canvas, act, tap = null) => {
  let pressed = null;
  const place = (event, act) => {
    const { left, top } = canvas.getBoundingClientRect();
    act(event.clientX - left, event.clientY - top);
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    pressed = tap?.wanted() ? event : null;
    if (!pressed) place(event, act);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!canvas.hasPointerCapture(event.pointerId)) return;
    if (pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < STILL) return;
    pressed = null;
    place(event, act);
  });
  canvas.addEventListener("pointerup", () => {
    if (pressed) place(pressed, tap.act);
    pressed = null;
  });
  canvas.addEventListener("pointercancel", () => { pressed = null; });
};

/** Keys; what is typed into a field, and what a control does with a key itself, is left alone. */
const press = (page, event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
  const { target } = event;
  const writes = target.matches("input[type=text], select, textarea");
  const acts = target.matches("button, summary, input[type=checkbox], a");
  if (writes || (acts && [" ", "Enter"].includes(event.key))) return;
  const actions = {
    ArrowLeft: () => page.step(-1), ArrowRight: () => page.step(1), PageDown: () => page.step(-10), PageUp: () => page.step(10),
    Home: () => page.home(), End: () => page.end(), b: () => page.jump(-1), n: () => page.jump(1), " ": () => page.play(),
    p: () => page.pin(), d: () => page.pinned && page.set("difference"), l: () => page.set("log"), k: () => page.lock(),
    s: () => page.paths?.startHere(), c: () => page.set("contours"), m: () => page.set("marks"), "?": () => $("keys").showModal(),
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
  if ((target.closest("#parameters") || target === $("phase")) && event.key.startsWith("Arrow")) return;
  const act = actions[event.key];
  if (!act) return;
  event.preventDefault();
  act();
};

