// The plane of two parameters: regions of one signature, the curves between them, the points where these meet, and where the shown state lies.

/** Grounds of regions and lines of curves; readable by the colour-blind. */
const GROUNDS = ["#56b4e9", "#e69f00", "#009e73", "#cc79a7", "#f0e442", "#0072b2", "#d55e00"];
/** How much of its colour a ground has. */
const TINT = 0.38;

const channels = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
const mixed = (colour, paper, share) => {
  const [a, b] = [channels(colour), channels(paper)];
  return `#${a.map((value, i) => Math.round(share * value + (1 - share) * b[i]).toString(16).padStart(2, "0")).join("")}`;
};
/** A colour as a pixel of an image. */
const pixelOf = (colour) => new Uint32Array(new Uint8Array([...channels(colour), 255]).buffer)[0];

const groundOf = (regions, kind, theme) =>
  regions.kinds[kind] ? mixed(GROUNDS[kind % GROUNDS.length], theme.paper, TINT) : theme.empty;
const kindWords = (words) => words || "no steady state, or not converged";

/** Indicators of curves, in the order in which they were followed: each has a line of its own. */
const methodsOf = (found) => [...new Set(found.curves.map(({ method }) => method))];
const lineOf = (found, curve, theme) => [theme.ink, theme.cursor, theme.line, theme.pinned][methodsOf(found).indexOf(curve.method) % 4];

/** The curves of one watched density, and those of levels, which are of none. */
const curvesOf = (found, k) => found.curves.filter((curve) => curve.observable === k || curve.observable === null);

/** Rows of a legend: each a list of entries with their places. */
const legendRows = (entries, width, size) => {
  const rows = [[]];
  let at = 0;
  for (const entry of entries) {
    const wide = 2.6 * size + textWidth(entry.words, size);
    if (at + wide > width && rows[rows.length - 1].length) {
      rows.push([]);
      at = 0;
    }
    rows[rows.length - 1].push({ ...entry, at });
    at += wide + size;
  }
  return rows;
};

const legendEntries = (found, k, theme) => {
  if (!found) return [];
  const regions = found.regions[k];
  const grounds = regions.places.map(({ kind }) => kind).filter((kind, i, all) => all.indexOf(kind) === i)
    .map((kind) => ({ ground: groundOf(regions, kind, theme), words: kindWords(regions.kinds[kind]) }));
  const curves = curvesOf(found, k);
  const lines = methodsOf({ curves }).map((method) => ({
    line: lineOf(found, { method }, theme), words: `${method} is zero`,
  }));
  const doubtful = curves.some(({ statuses }) => statuses.some((status) => status !== "located"));
  if (doubtful) lines.push({ line: theme.ink, dash: [5, 4], words: "not located" });
  return [...grounds, ...lines];
};

/** The plane without the cursor. */
const drawPlane = (pen, width, height, view, size) => {
  const { k, theme, scene } = view;
  const { sides, found } = scene.plane;
  const [x, y] = sides.map(({ from, to }) => [from, to]);
  const rows = legendRows(legendEntries(found, k, theme), width - 2 * size, size);
  const below = roomBelow(size) + (found ? 1.5 * size * rows.length + 0.4 * size : 0);
  const inner = height - below - 1.2 * size;
  const left = marginFor(y, inner, size);
  const rect = { left, top: 0.8 * size, width: Math.max(40, width - left - 1.6 * size), height: inner };
  const plot = new Plot(pen, rect, x, y, theme, size);
  if (found) {
    drawRegions(plot, found.regions[k], theme);
    plot.clipped(() => curvesOf(found, k).forEach((curve) => drawCurve(plot, found, curve)));
    drawRegionWords(plot, found.regions[k], view, size);
  } else {
    plot.pen.text(rect.left + 0.5 * rect.width, rect.top + 0.45 * rect.height, "click to go there", { colour: theme.faint, size });
  }
  if (view.source.all) drawNodes(plot, view.source, theme);
  if (found) drawSpecialPoints(plot, found, k, size);
  plot.axes(...sides.map(({ symbol }) => symbol));
  drawLegend(plot, rows, height - below + roomBelow(size) + 1.1 * size, size);
  return plot;
};

const drawRegions = (plot, regions, theme) => {
  const kinds = regions.bytes ??= fromBase64(regions.pixels);
  const grounds = regions.kinds.map((_, kind) => pixelOf(groundOf(regions, kind, theme)));
  const [wide, high] = regions.size;
  plot.pen.image(plot.rect, (image, columns, lines) => {
    for (let line = 0; line < lines; line++) {
      const row = high - 1 - Math.min(high - 1, Math.floor(((line + 0.5) * high) / lines));
      for (let column = 0; column < columns; column++) {
        image[line * columns + column] = grounds[kinds[row * wide + Math.min(wide - 1, Math.floor(((column + 0.5) * wide) / columns))]];
      }
    }
  });
};

/** A curve with the band of its error; dashed where it is not located. */
const drawCurve = (plot, found, curve) => {
  const { pen, theme } = plot;
  const colour = lineOf(found, curve, theme);
  const edge = (sign) => curve.points.map(([x, y, , dx, dy]) => plot.place([x + sign * dx, y + sign * dy]));
  pen.area([...edge(1), ...edge(-1).reverse()], { colour, alpha: 0.25 });
  const sound = curve.statuses.map((status) => status === "located");
  let piece = [];
  curve.points.forEach((point, i) => {
    piece.push(plot.place(point));
    const last = i + 1 === curve.points.length;
    const is = sound[i] && (last || sound[i + 1]);
    const was = i === 0 ? is : sound[i - 1] && sound[i];
    if (piece.length > 1 && (last || is !== was)) {
      pen.line(piece, { colour, width: 1.8, dash: was ? [] : [5, 4] });
      piece = [plot.place(point)];
    }
  });
};

/** The words of regions that have room for them. */
const drawRegionWords = (plot, regions, view, size) => {
  const { pen, rect, theme } = plot;
  const kinds = regions.bytes;
  const [wide, high] = regions.size;
  const kindAt = (x, y) => {
    const share = [(x - rect.left) / rect.width, (rect.top + rect.height - y) / rect.height];
    if (share.some((one) => one < 0 || one >= 1)) return -1;
    return kinds[Math.floor(share[1] * high) * wide + Math.floor(share[0] * wide)];
  };
  for (const { kind, at } of regions.places.slice(0, 12)) {
    const words = kindWords(regions.kinds[kind]);
    const half = 0.5 * textWidth(words, size) + 0.3 * size;
    const [x, y] = [rect.left + at[0] * rect.width, rect.top + (1 - at[1]) * rect.height];
    const corners = [-half, -0.5 * half, 0, 0.5 * half, half].flatMap((dx) => [[x + dx, y - 0.9 * size], [x + dx, y + 0.9 * size]]);
    if (corners.every(([px, py]) => kindAt(px, py) === kind)) pen.text(x, y + 0.35 * size, words, { colour: theme.ink, size });
  }
};

/** Where densities stand in the page. */
const drawNodes = (plot, source, theme) => {
  const apart = plot.rect.width / Math.max(source.rows[0].length, 1);
  if (apart < 9) return;
  for (const { value, second } of source.all) {
    const [x, y] = plot.place([value, second]);
    plot.pen.area([[x - 0.8, y - 0.8], [x + 0.8, y - 0.8], [x + 0.8, y + 0.8], [x - 0.8, y + 0.8]], { colour: theme.faint, alpha: 0.7 });
  }
};

const drawSpecialPoints = (plot, found, k, size) => {
  const { pen, rect, theme } = plot;
  const names = curvesOf(found, k).map(({ name }) => name);
  for (const { label, at, curves } of found.points) {
    if (!curves.split(" ").some((name) => names.includes(name))) continue;
    const [x, y] = plot.place(at);
    const round = Array.from({ length: 17 }, (_, i) => [x + 4 * Math.cos((i * Math.PI) / 8), y + 4 * Math.sin((i * Math.PI) / 8)]);
    pen.area(round, { colour: theme.paper, edge: theme.ink, width: 1.4 });
    const right = x > rect.left + 0.7 * rect.width;
    const down = y < rect.top + 2 * size ? 1.2 * size : -0.5 * size;
    pen.text(x + (right ? -7 : 7), y + down, label, { colour: theme.ink, size: 0.95 * size, align: right ? "right" : "left", halo: theme.paper });
  }
};

const drawLegend = (plot, rows, top, size) => {
  const { pen, theme } = plot;
  rows.forEach((row, number) => row.forEach(({ at, words, ground, line, dash }) => {
    const [x, y] = [size + at, top + 1.5 * size * number];
    const box = [[x, y - 0.8 * size], [x + 1.6 * size, y - 0.8 * size], [x + 1.6 * size, y + 0.15 * size], [x, y + 0.15 * size]];
    if (ground) pen.area(box, { colour: ground, edge: theme.faint, width: 1 });
    else pen.line([[x, y - 0.3 * size], [x + 1.6 * size, y - 0.3 * size]], { colour: line, width: 1.8, dash: dash ?? [] });
    pen.text(x + 2.1 * size, y, words, { colour: theme.ink, size, align: "left" });
  }));
};

/** Where the shown and the pinned state lie. */
const drawPlaneCursor = (plot, view) => {
  const { pen, rect, theme, ranges } = plot;
  const cross = ([a, b], colour) => {
    if (a < ranges.x[0] || a > ranges.x[1] || b < ranges.y[0] || b > ranges.y[1]) return;
    const [x, y] = plot.place([a, b]);
    const lines = [[[rect.left, y], [rect.left + rect.width, y]], [[x, rect.top], [x, rect.top + rect.height]]];
    for (const line of lines) pen.line(line, { colour, width: 1, alpha: 0.6 });
    const round = Array.from({ length: 25 }, (_, i) => [x + 6 * Math.cos((i * Math.PI) / 12), y + 6 * Math.sin((i * Math.PI) / 12)]);
    pen.line(round, { colour: theme.paper, width: 5 });
    pen.line(round, { colour, width: 2.5 });
  };
  if (view.pinned?.second !== undefined) cross([view.pinned.value, view.pinned.second], theme.pinned);
  if (view.frame?.second !== undefined) cross([view.frame.value, view.frame.second], theme.cursor);
};

/** Curves and points of codimension two as a table; `go` is what a click does. */
const planeTable = (scene, source, go) => {
  const { sides, found } = scene.plane;
  if (!found) return [make("p", {}, "No map yet: “Map the plane” finds its regions and follows the curves between them.")];
  const button = (name, at) => make("button", { type: "button", onclick: () => go(at), title: `Go to ${name}` }, name);
  const places = (at, error) => sides.map(({ symbol, from, to }, i) => make("div", {}, nodes(symbol), ` = ${withError(at[i], error * (to - from))}`));
  const special = found.points.map((point) => make("tr", {}, make("td", {}, button(point.label, point.at)), make("td", {}, places(point.at, point.error)),
    make("td", {}, `${point.kind}${point.curves ? ` of ${point.curves.split(" ").join(", ")}` : ""}`), make("td", {}, point.status)));
  const curves = found.curves.map((curve) => {
    const located = curve.statuses.filter((status) => status === "located").length;
    const density = curve.observable === null ? "" : nodes(source.observables[curve.observable].title);
    const middle = curve.points[Math.floor(curve.points.length / 2)];
    const worst = Math.max(...curve.points.map((point) => point[2]));
    return make("tr", {}, make("td", {}, button(curve.name, middle)),
      make("td", {}, `${curve.points.length} points`, make("div", { class: "hint" }, `errors up to ${plainNumber(worst, 2)} of the box`)),
      make("td", {}, `${curve.method} of `, density, " is zero"), make("td", {}, located === curve.points.length ? "located" : `${located} located`));
  });
  const head = ["label", "place", "what", "status"].map((name) => make("th", { scope: "col" }, name));
  return [make("table", {}, make("thead", {}, make("tr", {}, head)), make("tbody", {}, [...special, ...curves])),
    make("p", { class: "hint" }, `${found.nodes} nodes were solved.`)];
};

/** The points of the curves as a table. */
const planeCsv = (scene) => {
  const { sides, found } = scene.plane;
  const lines = [["curve", "label", ...sides.map(({ name }) => name), "error", "status", "method"].join(",")];
  for (const curve of found?.curves ?? []) {
    curve.points.forEach(([x, y, error], i) => lines.push([curve.name, curve.labels[i], x, y, error, curve.statuses[i], curve.method].join(",")));
  }
  return `${lines.join("\n")}\n`;
};
