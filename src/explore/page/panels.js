// The panels of the page: joint density, marginals, diagram. Each draws itself with any pen into any size.

/** Shares of the largest value at which contours are drawn. */
const LEVELS = [0.1, 0.3, 0.5, 0.7, 0.9];
/** Logarithmic contours: powers of ten below the largest value. */
const LOG_LEVELS = [0.1, 1e-2, 1e-3, 1e-4, 1e-5];

const EMPTY_WORDS = {
  "no-steady-state": "no steady state in Ω",
  "several-classes": "several steady states",
};

/** What stands where a density would, in words. */
const drawEmpty = (pen, rect, theme, size, words) => {
  const { left, top, width, height } = rect;
  pen.clipped(rect, () => {
    for (let x = -height; x < width; x += 12) {
      pen.line([[left + x, top + height], [left + x + height, top]], { colour: theme.empty, width: 1 });
    }
  });
  pen.text(left + 0.5 * width, top + 0.5 * height, words, { colour: theme.ink, size: 1.3 * size, halo: theme.paper });
};

const emptyWords = (frame) => (frame ? EMPTY_WORDS[frame.status] ?? "no density" : "waiting for the first density");

/** Sides of which one is at most so many times as long as the other have one scale. */
const ALIKE = 2;

/** The rectangle in which a unit is as long across as up, where both axes are about as long; else the whole. */
const withEqualScales = (rect, [x0, x1], [y0, y1]) => {
  const longer = (x1 - x0) / (y1 - y0);
  if (!(longer <= ALIKE && longer >= 1 / ALIKE)) return rect;
  const scale = Math.min(rect.width / (x1 - x0), rect.height / (y1 - y0));
  const [width, height] = [scale * (x1 - x0), scale * (y1 - y0)];
  return { left: rect.left + 0.5 * (rect.width - width), top: rect.top + 0.5 * (rect.height - height), width, height };
};

/** The two middles about a place, the first of them, and the share of the second; -1 outside of the cells. */
const between = (edges, middles, value) => {
  if (cellOf(edges, value) < 0) return [-1, 0];
  const low = Math.min(Math.max(cellOf(middles, value), 0), middles.length - 2);
  return [value < middles[0] ? 0 : value > middles[middles.length - 1] ? middles.length - 2 : low,
    clamp((value - middles[low]) / (middles[low + 1] - middles[low]), 0, 1)];
};

/** The image of a joint density over a plot, linear between the middles of cells. */
const drawSmoothHeat = (plot, observable, values, colours) => {
  const { edges, centres: [xs, ys] } = observable;
  const rows = ys.length;
  const palette = coloursOf(colours).pixels;
  const share = shareOf(colours);
  plot.pen.image(plot.rect, (image, columns, lines) => {
    const { left, top, width, height } = plot.rect;
    const across = Array.from({ length: columns }, (_, c) => between(edges[0], xs, plot.x.from(left + ((c + 0.5) / columns) * width)));
    const up = Array.from({ length: lines }, (_, l) => between(edges[1], ys, plot.y.from(top + ((l + 0.5) / lines) * height)));
    for (let line = 0; line < lines; line++) {
      const [j, v] = up[line];
      for (let column = 0; column < columns; column++) {
        const [i, u] = across[column];
        if (i < 0 || j < 0) {
          image[line * columns + column] = 0;
          continue;
        }
        const at = i * rows + j;
        const value = (1 - u) * ((1 - v) * values[at] + v * values[at + 1]) + u * ((1 - v) * values[at + rows] + v * values[at + rows + 1]);
        image[line * columns + column] = palette[Math.round(255 * clamp(share(value), 0, 1))];
      }
    }
  });
};

/** The image of a joint density over a plot, cell by cell: sampling noise is not smoothed away. */
const drawHeat = (plot, observable, values, colours) => {
  const { edges } = observable;
  const rows = edges[1].length - 1;
  const palette = coloursOf(colours).pixels;
  const share = shareOf(colours);
  plot.pen.image(plot.rect, (image, columns, lines) => {
    const { left, top, width, height } = plot.rect;
    const across = Array.from({ length: columns }, (_, c) => cellOf(edges[0], plot.x.from(left + ((c + 0.5) / columns) * width)));
    const up = Array.from({ length: lines }, (_, l) => cellOf(edges[1], plot.y.from(top + ((l + 0.5) / lines) * height)));
    const shades = new Uint32Array(values.length);
    for (let i = 0; i < values.length; i++) shades[i] = palette[Math.round(255 * clamp(share(values[i]), 0, 1))];
    for (let line = 0; line < lines; line++) {
      for (let column = 0; column < columns; column++) {
        const inside = across[column] >= 0 && up[line] >= 0;
        image[line * columns + column] = inside ? shades[across[column] * rows + up[line]] : 0;
      }
    }
  });
};

/** Joint density of two axes as heat map with contours, or its difference to the pinned one. */
const drawJoint = (pen, width, height, view, size) => {
  const { source, frame, pinned, k, theme, options } = view;
  const observable = gridOf(source, frame, k);
  const values = frame?.densities[k]?.values;
  const same = gridOf(source, pinned, k) === observable;
  const against = options.difference && same && pinned?.densities[k]?.values;
  const shown = values && against ? values.map((value, i) => value - against[i]) : values;
  // Components of a current have either sign.
  const signed = against || (observable.field !== null && values?.some((value) => value < -1e-3 * largest(values)));
  const top = signed && shown ? Math.max(largest(shown), largest(shown.map((value) => -value)))
    : options.lock || (values ? largest(values) : 1);
  const colours = { kind: signed ? "difference" : options.log ? "log" : "linear", top };
  const [x, y] = [view.window(k, 0), view.window(k, 1)];
  const inner = height - roomBelow(size) - 1.8 * size;
  const left = marginFor(y, inner, size);
  const whole = { left, top: 1.8 * size, width: Math.max(40, width - left - roomForBar(colours, inner, size)), height: inner };
  const rect = withEqualScales(whole, x, y);
  const plot = new Plot(pen, rect, x, y, theme, size);
  if (!shown) drawEmpty(pen, rect, theme, size, emptyWords(frame));
  else {
    const isSmooth = frame.method === "generator" && observable.centres.every((middles) => middles.length > 1);
    (isSmooth ? drawSmoothHeat : drawHeat)(plot, observable, shown, colours);
    if (options.contours) drawContours(plot, observable, shown, colours, largest(values));
    if (view.paths.length) drawPaths(plot, view.paths, size);
    if (options.marks) plot.clipped(() => drawMarks(plot, frame.found[k], size));
    // What a field is called is too long for the bar, and stands above the panel.
    const title = observable.field === null ? observable.title : "";
    colourBar(pen, rect, colours, theme, size, against ? `Δ${title}` : title);
  }
  if (view.section !== null && shown) {
    const level = plot.y.to(view.section);
    plot.clipped(() => {
      pen.line([[rect.left, level], [rect.left + rect.width, level]], { colour: "#000", width: 3.5, alpha: 0.6 });
      pen.line([[rect.left, level], [rect.left + rect.width, level]], { colour: "#fff", width: 1.5 });
    });
  }
  plot.axes(observable.symbols[0], observable.symbols[1]);
  return plot;
};

const drawContours = (plot, observable, values, colours, top) => {
  if (colours.kind === "difference") {
    plot.clipped(() => [-0.5, -0.1, 0.1, 0.5].forEach((share) =>
      plot.pen.segments(crossings(plot, observable, values, share * colours.top), { colour: "#444", width: 0.8 })));
    return;
  }
  plot.clipped(() => {
    for (const level of colours.kind === "log" ? LOG_LEVELS : LEVELS) {
      const shade = shareOf(colours)(level * top);
      const colour = shade > 0.55 ? "#000" : "#fff";
      plot.pen.segments(crossings(plot, observable, values, level * top), { colour, width: 0.8 });
    }
  });
};

const crossings = (plot, { centres: [xs, ys] }, values, level) =>
  contour(values, xs.map(plot.x.to), ys.map(plot.y.to), level);

const drawMarks = (plot, found, size) => {
  const features = found?.features ?? [];
  const peaks = features.filter(({ kind }) => kind === "peak").map(({ at }) => plot.place(at));
  // On a rim that is nearly level a saddle is found anywhere, and its sign must not hide that of a peak.
  const hides = ([x, y]) => peaks.some(([px, py]) => Math.hypot(px - x, py - y) < 0.9 * size);
  for (const mark of features) {
    const [x, y] = plot.place(mark.at);
    if (mark.kind === "valley" && hides([x, y])) continue;
    drawMark(plot.pen, mark.kind, x, y, { colour: "#fff", halo: "#000", radius: 0.34 * size, alpha: mark.certain ? 1 : 0.5 });
  }
};

/** A density of one variable as line with its band, features marked, and the pinned one dashed. */
const drawMarginal = (pen, width, height, view, size) => {
  const { source, frame, pinned, k, theme, options } = view;
  const observable = gridOf(source, frame, k);
  const density = frame?.densities[k];
  const x = view.window(k, 0);
  const heights = [density, pinned?.densities[k]].map((one) => (one ? largest(one.values) : 0));
  // Locked colours lock the heights too: states can then be compared by eye.
  const y = [0, roundUp(1.05 * ((options.lock ? source.tops[k] : Math.max(...heights)) || 1))];
  const left = marginFor(y, height - roomBelow(size), size);
  const rect = { left, top: 0.8 * size, width: width - left - 0.8 * size, height: height - roomBelow(size) - 0.8 * size };
  const plot = new Plot(pen, rect, x, y, theme, size);
  plot.axes(observable.symbols[0], observable.title, { grid: true });
  if (!density) drawEmpty(pen, rect, theme, size, emptyWords(frame));
  plot.clipped(() => {
    if (density) drawBand(plot, observable, density);
    const other = pinned?.densities[k];
    if (other) pen.line(curve(plot, gridOf(source, pinned, k), other.values), { colour: theme.pinned, width: 1.8, dash: [6, 4] });
    if (density) pen.line(curve(plot, observable, density.values), { colour: theme.line, width: 2 });
    if (!options.marks || !density) return;
    for (const mark of frame.found[k]?.features ?? []) {
      const [px, py] = plot.place([mark.at[0], mark.density]);
      drawMark(pen, mark.kind, px, py, { colour: theme.mark, halo: theme.paper, radius: 0.34 * size, alpha: mark.certain ? 1 : 0.45 });
    }
  });
  return plot;
};

const curve = (plot, observable, values) => observable.centres[0].map((x, i) => plot.place([x, values[i]]));

const drawBand = (plot, observable, { values, band }) => {
  if (!band) return;
  const xs = observable.centres[0];
  const above = xs.map((x, i) => plot.place([x, values[i] + band[i]]));
  const below = xs.map((x, i) => plot.place([x, values[i] - band[i]]));
  plot.pen.area([...above, ...below.reverse()], { colour: plot.theme.line, alpha: 0.25 });
};

/** The section of a joint density along its first axis, through `view.section` of the second. */
const drawSection = (pen, width, height, view, size) => {
  const { source, frame, pinned, k, theme } = view;
  const observable = source.observables[k];
  const cut = (of) => {
    const { edges, centres: [xs, ys] } = gridOf(source, of, k);
    const row = cellOf(edges[1], view.section);
    const values = of?.densities[k]?.values;
    return values && row >= 0 ? xs.map((_, i) => values[i * ys.length + row]) : null;
  };
  const [here, there] = [cut(frame), cut(pinned)];
  const top = Math.max(here ? largest(here) : 0, there ? largest(there) : 0, 1e-300);
  const y = [0, roundUp(1.05 * top)];
  const left = marginFor(y, height - roomBelow(size), size);
  const rect = { left, top: 0.8 * size, width: width - left - 0.8 * size, height: height - roomBelow(size) - 0.8 * size };
  const plot = new Plot(pen, rect, view.window(k, 0), y, theme, size);
  plot.axes(observable.symbols[0], `p(${observable.symbols[0]}, ${number(view.section, 3)})`, { grid: true });
  if (!here) drawEmpty(pen, rect, theme, size, emptyWords(frame));
  plot.clipped(() => {
    if (there) pen.line(curve(plot, gridOf(source, pinned, k), there), { colour: theme.pinned, width: 1.8, dash: [6, 4] });
    if (here) pen.line(curve(plot, gridOf(source, frame, k), here), { colour: theme.line, width: 2 });
  });
  return plot;
};

/** Ends of the columns of the diagram: half-way between neighbouring values. */
const columnEdges = (values) => {
  if (values.length < 2) return [values[0] - 0.5, values[0] + 0.5];
  const between = values.slice(1).map((value, i) => 0.5 * (value + values[i]));
  return [values[0], ...between, values[values.length - 1]];
};

/** The diagram of a marginal over the parameter, without the cursor. */
const drawDiagram = (pen, width, height, view, size) => {
  const { source, k, theme, scene, options } = view;
  const observable = source.observables[k];
  const frames = source.frames;
  const y = view.window(k, 0);
  const colours = { kind: options.log ? "log" : "linear", top: source.tops[k] || 1 };
  const top = 4 + 1.3 * size * (labelRows(view, 0.85 * width, size) + 0.2);
  const inner = height - roomBelow(size) - top;
  const left = marginFor(y, inner, size);
  const rect = { left, top, width: width - left - roomForBar(colours, inner, size), height: inner };
  const plot = new Plot(pen, rect, view.range, y, theme, size);
  drawColumns(plot, frames, observable, k, colours);
  plot.clipped(() => drawBranches(plot, frames, k, size));
  drawLabels(plot, view, size);
  plot.axes(scene.swept.symbol, observable.symbols[0]);
  colourBar(pen, rect, colours, theme, size, observable.title);
  return plot;
};

const drawColumns = (plot, frames, observable, k, colours) => {
  if (!frames.length) return;
  const edges = columnEdges(frames.map((frame) => frame.value));
  const palette = coloursOf(colours).pixels;
  const share = shareOf(colours);
  const { left, top, width, height } = plot.rect;
  const shades = frames.map((frame) => {
    const values = frame.densities[k]?.values;
    return values && Uint32Array.from(values, (value) => palette[Math.round(255 * clamp(share(value), 0, 1))]);
  });
  plot.pen.image(plot.rect, (image, columns, lines) => {
    const cells = new Map();
    const upAlong = (grid) => {
      const cell = (_, line) => cellOf(grid.edges[0], plot.y.from(top + ((line + 0.5) / lines) * height));
      if (!cells.has(grid)) cells.set(grid, Array.from({ length: lines }, cell));
      return cells.get(grid);
    };
    for (let column = 0; column < columns; column++) {
      const number = cellOf(edges, plot.x.from(left + ((column + 0.5) / columns) * width));
      const shade = shades[number];
      if (!shade) continue;
      const up = upAlong(frames[number].densities[k].grid ?? observable);
      for (let line = 0; line < lines; line++) if (up[line] >= 0) image[line * columns + column] = shade[up[line]];
    }
  });
};

/** Peaks as dots, valleys as small circles. */
const drawBranches = (plot, frames, k, size) => {
  let before = -Infinity;
  for (const frame of frames) {
    const x = plot.x.to(frame.value);
    // Values that lie closer together than a dot is wide are drawn once.
    if (x - before < 0.12 * size) continue;
    before = x;
    for (const mark of frame.found[k]?.features ?? []) {
      if (!mark.certain) continue;
      const y = plot.y.to(mark.at[0]);
      const r = 0.16 * size;
      const dot = Array.from({ length: 9 }, (_, i) => [x + r * Math.cos((i * Math.PI) / 4), y + r * Math.sin((i * Math.PI) / 4)]);
      if (mark.kind === "peak") plot.pen.area(dot, { colour: "#e8453c" });
      else plot.pen.line(dot, { colour: "#fff", width: 1.2 });
    }
  }
};

/** Located changes, each with the row in which its name stands so that names do not overlap. */
const placedLabels = (view, width, size) => {
  const changes = view.scene.labels.filter((label) => label.kind === "bifurcation");
  const ends = [];
  return changes.map((label) => {
    const x = (label.value - view.range[0]) / (view.range[1] - view.range[0]);
    let row = ends.findIndex((end) => end < x);
    if (row < 0) row = ends.length;
    ends[row] = x + (2.9 * size) / Math.max(width, 1);
    return { label, row };
  });
};
const labelRows = (view, width, size) => Math.max(1, ...placedLabels(view, width, size).map(({ row }) => row + 1));

const drawLabels = (plot, view, size) => {
  const { pen, rect, theme } = plot;
  const bottom = rect.top + rect.height;
  const placed = placedLabels(view, rect.width, size);
  for (const { label, row } of placed) {
    const own = label.observable === view.k;
    const [x, low, high] = [label.value, label.lower, label.upper].map(plot.x.to);
    plot.clipped(() => {
      if (high - low > 1) pen.area([[low, rect.top], [high, rect.top], [high, bottom], [low, bottom]], { colour: theme.cursor, alpha: 0.3 });
      pen.line([[x, rect.top], [x, bottom]], { colour: "#000", width: 3, alpha: own ? 0.5 : 0.25 });
      pen.line([[x, rect.top], [x, bottom]], { colour: "#fff", width: 1.4, dash: own ? [] : [3, 4] });
    });
    pen.line([[x, rect.top], [x, rect.top - 0.3 * size - 1.3 * size * row]], { colour: theme.faint, width: 1 });
  }
  // Names over all lines, so that none is struck through.
  for (const { label, row } of placed) {
    const own = label.observable === view.k;
    const place = [plot.x.to(label.value), rect.top - 0.45 * size - 1.3 * size * row];
    pen.text(...place, label.label, { colour: own ? theme.ink : theme.faint, size: 0.95 * size, halo: theme.paper });
  }
};

/** The cursor of the diagram, and where the pinned value stands. */
const drawCursor = (plot, view) => {
  const { pen, rect, theme } = plot;
  const bottom = rect.top + rect.height;
  const line = (value, colour, dash) => {
    // A typed value may lie beyond the diagram.
    if (value < plot.ranges.x[0] || value > plot.ranges.x[1]) return;
    const x = plot.x.to(value);
    pen.line([[x, rect.top], [x, bottom]], { colour: theme.paper, width: 4, alpha: 0.7 });
    pen.line([[x, rect.top], [x, bottom]], { colour, width: 2, dash });
    pen.area([[x - 6, bottom + 8], [x + 6, bottom + 8], [x, bottom]], { colour });
  };
  if (view.pinned) line(view.pinned.value, theme.pinned, [6, 4]);
  if (view.frame) line(view.at ?? view.frame.value, theme.cursor, []);
};

