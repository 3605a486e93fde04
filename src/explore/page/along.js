// The panel of numbers along the sweep: one column of the table of points, with the band of its error.

/** Numbers of cells and solvers: none of them is shown first. */
const OF_SOLVERS = /^(escape_rate|negative_mass|edge_mass.*|map_step|factorisations|numerical_diffusion.*)$/;

/** A column with a band that grows by more than this has a logarithmic axis, as in figures. */
const DECADES_FROM = 50;

/** The columns of numbers that frames have: name as in points.csv, title, unit, and value and error of a frame. */
const columnsOf = (scene, frames) => {
  const found = new Map();
  const add = (name, title, unit, of) => { if (!found.has(name)) found.set(name, { name, title, unit: unit === "1" ? "" : unit, of }); };
  scene.moment_names.forEach((name, i) => {
    add(`mean_${name}`, `mean of ${scene.moments[i]}`, "", ({ moments }) => [moments[i]?.[0], moments[i]?.[2]]);
    add(`sd_${name}`, `standard deviation of ${scene.moments[i]}`, "", ({ moments }) => [moments[i]?.[1], moments[i]?.[3]]);
  });
  for (const frame of frames) {
    for (const [name, , , unit] of frame.measures) {
      if (found.has(name)) continue;
      add(name, name.replaceAll("_", " "), unit, ({ measures }) => {
        const [, value, error] = measures.find(([other]) => other === name) ?? [];
        return [value, error];
      });
    }
  }
  add("solver_error", "solver's error", "", (frame) => [frame.solver_error]);
  add("residual", "residual", "", (frame) => [frame.residual]);
  add("distance", "distance to the value below", "", (frame) => [frame.distance]);
  const isKnown = ({ of }) => frames.some((frame) => isNumber(of(frame)[0]));
  return [...found.values()].filter(isKnown);
};

const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

/** What is shown first: a number that was asked for, else a standard deviation. */
const firstColumn = (scene, columns) => {
  const own = columns.find(({ name }) => !/^(mean|sd)_|^(solver_error|residual|distance)$/.test(name) && !OF_SOLVERS.test(name));
  return own ?? columns.find(({ name }) => name.startsWith("sd_")) ?? columns[0];
};

/** Places, values and errors of a column, ascending; an error that is not known is null. */
const seriesOf = (column, frames) => frames.flatMap((frame) => {
  const [value, error] = column.of(frame);
  return isNumber(value) ? [{ at: frame.value, value, error: isNumber(error) ? error : null }] : [];
});

/** Whether a column is positive beyond its errors and grows so much that a linear axis hides it. */
const isOverDecades = (series) => {
  const least = Math.min(...series.map(({ value }) => value));
  return series.every(({ value, error }) => value > (error ?? 0)) && Math.max(...series.map(({ value }) => value)) > DECADES_FROM * least;
};

/** The range of the axis: values with their bands, but for a band that is far wider than others. */
const rangeOf = (series, place) => {
  const values = series.map(({ value }) => place(value));
  let [low, high] = [Math.min(...values), Math.max(...values)];
  const widths = series.map(({ error }) => error ?? 0).sort((a, b) => a - b);
  const most = Math.max(3 * widths[widths.length >> 1], high - low);
  if (place(10) !== 1) {
    for (const { value, error } of series) {
      const reach = Math.min(error ?? 0, most);
      low = Math.min(low, value - reach);
      high = Math.max(high, value + reach);
    }
  }
  const missing = high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high)) ? 0 : 0.1 * Math.max(Math.abs(high), 1e-9);
  const border = 0.06 * (high - low) + missing;
  return [low - border, high + border];
};

/** A value with its error and its unit. */
const told = (column, [value, error]) => {
  if (!isNumber(value)) return "not known here";
  const unit = column.unit ? ` ${column.unit}` : "";
  return `${error ? withError(value, error) : plainNumber(value, 6)}${unit}`;
};

/** A column over the parameter with its band, and where changes were located; without the mark of the shown state. */
const drawNumbers = (pen, width, height, view, size) => {
  const { source, scene, theme, column } = view;
  const series = seriesOf(column, source.frames);
  const isLog = isOverDecades(series);
  const place = isLog ? Math.log10 : (value) => value;
  const y = rangeOf(series, place);
  const top = 4 + 1.3 * size * (labelRows(view, 0.85 * width, size) + 0.2);
  const inner = height - roomBelow(size) - top;
  const up = isLog ? powerTicks(y) : undefined;
  const left = marginFor(y, inner, size, up);
  const plot = new Plot(pen, { left, top, width: width - left - 1.8 * size, height: inner }, view.range, y, theme, size);
  plot.column = { column, place, y };
  const title = column.unit ? `${column.title} [${column.unit}]` : column.title;
  plot.axes(scene.swept.symbol, title, { grid: true, up });
  const end = ({ value, error }, sign) => {
    const found = place(value + sign * error);
    return Number.isFinite(found) ? clamp(found, ...y) : y[0];
  };
  plot.clipped(() => {
    const banded = series.filter(({ error }) => error > 0);
    if (banded.length === series.length) {
      const edge = (sign) => banded.map((one) => plot.place([one.at, end(one, sign)]));
      pen.area([...edge(1), ...edge(-1).reverse()], { colour: theme.line, alpha: 0.25 });
    }
    pen.line(series.map(({ at, value }) => plot.place([at, place(value)])), { colour: theme.line, width: 2 });
    if (series.length === 1) drawMark(pen, "peak", ...plot.place([series[0].at, place(series[0].value)]), { colour: theme.line, halo: theme.paper, radius: 0.3 * size });
  });
  drawLines(plot, view);
  return plot;
};

/** Located changes as thin lines with their names. */
const drawLines = (plot, view) => {
  const { pen, rect, theme, size } = plot;
  for (const { label, row } of placedLabels(view, rect.width, size)) {
    const x = plot.x.to(label.value);
    pen.line([[x, rect.top - 0.3 * size - 1.3 * size * row], [x, rect.top + rect.height]], { colour: theme.faint, width: 1, dash: [3, 4] });
    pen.text(x, rect.top - 0.45 * size - 1.3 * size * row, label.label, { colour: theme.faint, size: 0.95 * size, halo: theme.paper });
  }
};

/** Ticks of a logarithmic axis, whose range is in powers of ten. */
const powerTicks = ([low, high]) => {
  const factors = high - low < 2.5 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil((high - low) / 8));
  const values = [];
  for (let power = Math.floor(low); power <= high; power++) {
    if (power % every !== 0) continue;
    values.push(...factors.map((factor) => power + Math.log10(factor)).filter((value) => value >= low && value <= high));
  }
  return { values, words: values.map((value) => number(Number((10 ** value).toPrecision(6)), 1)) };
};

/** The mark of the shown state on its line, with its error, over what does not change with it. */
const drawHere = (plot, view) => {
  drawCursor(plot, view);
  const { column, place, y } = plot.column;
  const { pen, theme, size } = plot;
  for (const [frame, colour] of [[view.pinned, theme.pinned], [view.frame, theme.cursor]]) {
    const [value, error] = frame ? column.of(frame) : [];
    if (!isNumber(value) || !Number.isFinite(place(value))) continue;
    const [x, middle] = plot.place([frame.value, place(value)]);
    if (isNumber(error) && error > 0) {
      const [low, high] = [-1, 1].map((sign) => place(value + sign * error)).map((end) => clamp(Number.isFinite(end) ? end : y[0], ...y));
      pen.line([[x, plot.y.to(low)], [x, plot.y.to(high)]], { colour, width: 4 });
    }
    drawMark(pen, "peak", x, middle, { colour, halo: theme.paper, radius: 0.38 * size });
  }
};

/** A column as a table. */
const numbersCsv = (scene, column, frames) => {
  const lines = [[scene.swept.name, column.name, `${column.name}_error`].join(",")];
  for (const { at, value, error } of seriesOf(column, frames)) lines.push([at, value, error ?? ""].join(","));
  return `${lines.join("\n")}\n`;
};

/** What the page does with the panel: which column it shows, and when it is drawn. */
const Along = {
  /** The column that is shown. */
  column(page) {
    return page.columns.find(({ name }) => name === page.number) ?? firstColumn(page.scene, page.columns);
  },

  /** Draws the panel where it is to be drawn anew, then the mark of the shown state. */
  draw(page) {
    if (!page.drawn.numbers) {
      page.columns = columnsOf(page.scene, page.source.frames);
      $("numbers").hidden = page.columns.length === 0;
      if (!page.columns.length) return;
      this.choose(page);
      page.paint("numbers-canvas", drawNumbers, 0);
    }
    if (!page.drawn.numbers) return;
    const column = this.column(page);
    const words = `${plain(column.title)}: ${told(column, column.of(page.frame))}`;
    $("numbers-legend").textContent = `${words} at ${plain(page.scene.swept.symbol)} = ${plainNumber(page.frame.value, 6)}. The band is the error.`;
    page.paintOver("numbers", "mark-canvas", drawHere);
  },

  /** What can be chosen. */
  choose(page) {
    const names = page.columns.map(({ name }) => name).join();
    if ($("numbers-choice").dataset.names !== names) {
      fill($("numbers-choice"), page.columns.map(({ name, title }) => make("option", { value: name }, plain(title))));
      $("numbers-choice").dataset.names = names;
    }
    $("numbers-choice").value = this.column(page).name;
  },

  /** The command that draws the figure of the column. */
  command(column) {
    const isOfSolver = OF_SOLVERS.test(column.name) || ["solver_error", "residual", "distance"].includes(column.name);
    return `pbif plot RUN --only ${isOfSolver ? "health" : `measures_${column.name}`}`;
  },
};
