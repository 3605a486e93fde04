// What the page says in words: counts, status, numbers, the table of located changes, the facts of the model.

const make = (tag, attributes = {}, ...children) => {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (value === true) node.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) node.setAttribute(name, value);
  }
  node.append(...children.flat());
  return node;
};
const fill = (node, ...children) => node.replaceChildren(...children.flat());

const STATUS_WORDS = {
  solved: "Steady state found.",
  escaping: "Mass leaves Ω: the density is quasi-stationary, conditioned on staying.",
  "not-converged": "The solver stopped before its tolerance: what is shown is its last iterate.",
  "no-steady-state": "No steady state in Ω.",
  "several-classes": "Several steady states: which one is reached depends on the start.",
};
const isSound = (status) => status === "solved" || status === "escaping";

/** One sentence of what is seen at a frame, for people who listen and for the line above the panels. */
const sentence = (scene, source, frame) => {
  const second = scene.plane?.sides[1].symbol;
  const at = `${plain(scene.swept.symbol)} = ${plainNumber(frame.value, 6)}${second ? `, ${plain(second)} = ${plainNumber(frame.second, 6)}` : ""}`;
  if (!frame.densities.length) return `${at}: ${STATUS_WORDS[frame.status] ?? frame.status}`;
  const counts = densitiesOf(source).map((one, k) => `${plain(one.title)} ${countWords(frame.found[k])}`);
  return `${at}: ${counts.join("; ")}${isSound(frame.status) ? "" : `. ${STATUS_WORDS[frame.status]}`}`;
};
const countWords = (found) => (found ? found.words + (found.seen ? "" : " (its rim is not all seen on these cells)") : "–");

/** Counts, findings and numbers of a frame. */
const reading = ({ scene, source, frame, pinned }) => {
  const counts = densitiesOf(source).map((one, k) => [
    make("dt", {}, nodes(one.title)), make("dd", {}, countWords(frame.found[k])),
  ]);
  const notices = frame.preview ? [make("p", { class: "hint" }, "Preview on half as many cells an axis; refined when the slider rests.")] : [];
  notices.push(...frame.findings.map((finding) => make("p", { class: "notice" }, `${finding}.`)));
  if (!isSound(frame.status)) notices.unshift(make("p", { class: "notice" }, STATUS_WORDS[frame.status] ?? frame.status));
  const parts = [make("dl", { class: "counts" }, counts.flat()), ...notices];
  if (frame.moments.length) parts.push(momentsTable(scene, frame));
  if (pinned) parts.push(comparison(source, frame, pinned, scene));
  parts.push(numbersTable(frame));
  return parts;
};

const row = (name, ...values) =>
  make("tr", {}, make("th", { scope: "row" }, name), values.map((value) => make("td", { class: "number" }, nodes(value))));

const momentsTable = (scene, frame) => make("table", {},
  make("thead", {}, make("tr", {}, make("th", { scope: "col" }, "axis"),
    make("th", { scope: "col", class: "number" }, "mean"), make("th", { scope: "col", class: "number" }, "standard deviation"))),
  make("tbody", {}, frame.moments.map(([mean, deviation, ...errors], axis) => {
    // A mean that is rounding of the solver beside the width is zero to the eye.
    const shown = Math.abs(mean) < 1e-9 * deviation ? 0 : mean;
    const told = (value, error) => (error && value ? withError(value, error) : number(value, 5));
    return row(nodes(scene.moments[axis]), told(shown, errors[0]), told(deviation, errors[1]));
  })));

const comparison = (source, frame, pinned, scene) => {
  const rows = densitiesOf(source).map((one, k) => {
    const [p, q] = [frame.densities[k]?.values, pinned.densities[k]?.values];
    const same = gridOf(source, frame, k) === gridOf(source, pinned, k);
    return row(nodes(one.title), p && q && same ? number(hellinger(p, q, gridOf(source, frame, k).volumes), 4) : "–");
  });
  return make("table", {}, make("caption", {}, "Hellinger distance to the state pinned at ", nodes(scene.swept.symbol),
    ` = ${plainNumber(pinned.value, 6)} (0 the same, 1 nothing in common)`), make("tbody", {}, rows));
};

const numbersTable = (frame) => {
  const measures = frame.measures.map(([name, value, error, unit]) =>
    [name.replaceAll("_", " ") + (unit === "1" ? "" : `, ${unit}`), value, error]);
  const rows = [["residual", frame.residual], ["solver's error", frame.solver_error], ...measures,
    ["distance to the value below", frame.distance]];
  const shown = rows.filter(([, value]) => value !== null && value !== undefined);
  return make("details", {}, make("summary", {}, "Numbers of the solve"),
    make("table", {}, make("tbody", {}, row("method", frame.method), row("iterations", String(frame.iterations)),
      shown.map(([name, value, error]) => row(name, error ? withError(value, error) : number(value, 4))))));
};

/** The table of located changes, ends and failures; `go` is what a click does. */
const changesTable = (scene, source, go) => {
  if (!scene.labels.some(({ kind }) => kind !== "end")) {
    return [make("p", {}, scene.live ? "None yet: “Locate here” narrows the change nearest to the cursor."
      : "No change of topology was located on this sweep.")];
  }
  const head = ["label", "value", "of", "from … to", "status"].map((name) => make("th", { scope: "col" }, name));
  const rows = scene.labels.filter(({ kind }) => kind !== "end").map((label) => make("tr", { "data-at": label.value },
    make("td", {}, make("button", { type: "button", onclick: () => go(label.value), title: `Go to ${label.label}` }, label.label)),
    make("td", {}, withError(label.value, label.error)),
    make("td", {}, label.observable === null ? "" : nodes(source.observables[label.observable].title)),
    make("td", {}, label.kind === "failure" ? "no density to rely on" : `${label.before} → ${label.after}`,
      label.change ? make("div", { class: "hint" }, label.change) : ""),
    make("td", {}, label.status ?? "")));
  return [make("table", {}, make("thead", {}, make("tr", {}, head)), make("tbody", {}, rows))];
};

const MATHML = "http://www.w3.org/1998/Math/MathML";
/** What a layout may be made of. */
const LAYOUT = new Set(["mrow", "mi", "mn", "mo", "mtext", "mfrac", "msup", "msub", "msqrt", "mroot", "mover", "mtable", "mtr", "mtd"]);
const mathematics = ([tag, attributes, ...inner]) => {
  const node = document.createElementNS(MATHML, LAYOUT.has(tag) ? tag : "mrow");
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...inner.map((one) => (typeof one === "string" ? one : mathematics(one))));
  return node;
};

/** The parts of a row and of the rows in it, but for those in brackets. */
const partsOf = ([tag, attributes, ...inner]) => {
  const isOpen = tag === "mrow" && !(inner[0]?.[0] === "mo" && "([{|".includes(inner[0][2]));
  return isOpen ? inner.flatMap(partsOf) : [[tag, attributes, ...inner]];
};

/** The pieces of an equation between which a line may break: before each sign of a sum. */
const pieces = (layout) => {
  const found = [];
  let relation = true;
  for (const part of partsOf(layout)) {
    const isSign = part[0] === "mo" && ["+", "−", "-"].includes(part[2]);
    // A sign behind a relation belongs to the term behind it.
    if (!found.length || (isSign && !relation)) found.push([]);
    const follows = isSign && !relation && found.length > 1;
    found[found.length - 1].push(follows ? [part[0], { ...part[1], form: "infix" }, part[2]] : part);
    relation = part[0] === "mo" && !isSign;
  }
  return found;
};

/** The equations typeset, each in pieces that stand on several lines where one has no room; as text for those who listen, and for browsers that know no MathML. */
const equations = (scene) => scene.model.equations.map(({ text, layout }) => {
  if (typeof MathMLElement === "undefined") return make("code", {}, text);
  const typeset = (parts) => {
    const math = document.createElementNS(MATHML, "math");
    math.setAttribute("displaystyle", "true");
    math.setAttribute("aria-hidden", "true");
    math.append(mathematics(["mrow", {}, ...parts]));
    return math;
  };
  return make("span", { class: "equation", role: "math", "aria-label": text }, pieces(layout).map(typeset));
});

/** Parameters and the sweep file. */
const facts = (scene) => [
  make("h3", {}, scene.model.title),
  make("table", {}, make("tbody", {}, scene.parameters.map((parameter) => make("tr", {},
    make("th", { scope: "row" }, nodes(parameter.symbol)), make("td", {}, parameter.meaning),
    make("td", {}, parameter.value === null ? "swept" : parameter.name === scene.plane?.sides[1].name ? "mapped" : plainNumber(parameter.value, 6)))))),
  make("p", { class: "hint" }, `Source: ${scene.model.source}`),
  make("pre", { tabindex: "0", "aria-label": "Sweep file" }, scene.sweep_file),
];

