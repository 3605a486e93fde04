// A rectangle with two axes, and what is drawn in it whatever the density.

/** Places of values along a side: `to` in pixels from a value, `from` the other way. */
const along = ([low, high], start, end) => ({
  to: (value) => start + ((value - low) / (high - low)) * (end - start),
  from: (place) => low + ((place - start) / (end - start)) * (high - low),
});

class Plot {
  /** A plot over the ranges `x` and `y` in a rectangle; `size` is that of the lettering. */
  constructor(pen, rect, x, y, theme, size) {
    Object.assign(this, { pen, rect, theme, size, ranges: { x, y } });
    this.x = along(x, rect.left, rect.left + rect.width);
    this.y = along(y, rect.top + rect.height, rect.top);
  }

  place([x, y]) {
    return [this.x.to(x), this.y.to(y)];
  }

  clipped(draw) {
    this.pen.clipped(this.rect, draw);
  }

  /** Frame, ticks and names of the axes. */
  axes(xName, yName, { grid = false, up = null } = {}) {
    const { pen, rect, theme, size } = this;
    const { left, top, width, height } = rect;
    const bottom = top + height;
    const across = ticks(...this.ranges.x, width / (4.5 * size));
    const upright = up ?? upTicks(this.ranges.y, height, size);
    const thin = { colour: theme.faint, width: 1 };
    tickWords(across).forEach((word, i) => {
      const x = this.x.to(across.values[i]);
      if (grid) pen.line([[x, top], [x, bottom]], { colour: theme.grid, width: 1 });
      pen.line([[x, bottom], [x, bottom + 4]], thin);
      pen.text(x, bottom + 5 + size, word, { colour: theme.ink, size });
    });
    upright.words.forEach((word, i) => {
      const y = this.y.to(upright.values[i]);
      if (grid) pen.line([[left, y], [left + width, y]], { colour: theme.grid, width: 1 });
      pen.line([[left - 4, y], [left, y]], thin);
      pen.text(left - 7, y + 0.35 * size, word, { colour: theme.ink, size, align: "right" });
    });
    pen.line([[left, top], [left + width, top], [left + width, bottom], [left, bottom], [left, top]], thin);
    pen.text(left + 0.5 * width, bottom + 2.6 * size + 4, xName, { colour: theme.ink, size: 1.1 * size });
    pen.text(left - marginFor(this.ranges.y, height, size, upright) + 1.1 * size, top + 0.5 * height, yName,
      { colour: theme.ink, size: 1.1 * size, turned: true });
  }
}

/** Ticks of an upright axis, with what stands beside them. */
const upTicks = (range, height, size) => {
  const found = ticks(...range, height / (3 * size));
  return { values: found.values, words: tickWords(found) };
};

/** Room that an upright axis needs to its left. */
const marginFor = (range, height, size, up = upTicks(range, height, size)) => {
  const { words } = up;
  return Math.max(...words.map((word) => textWidth(word, size)), size) + 2.2 * size + 8;
};

/** Room that a level axis needs below. */
const roomBelow = (size) => 3.1 * size + 4;

/** A bar of colours with its ticks, right of a rectangle. */
const colourBar = (pen, rect, colours, theme, size, name) => {
  const left = rect.left + rect.width + 10;
  const wide = 12;
  const palette = coloursOf(colours).pixels;
  pen.image({ left, top: rect.top, width: wide, height: rect.height }, (image, columns, rows) => {
    for (let row = 0; row < rows; row++) {
      image.fill(palette[Math.round(255 * (1 - row / Math.max(rows - 1, 1)))], row * columns, (row + 1) * columns);
    }
  });
  const { values, words, share } = barTicks(colours, rect.height / (2.6 * size));
  values.forEach((value, i) => {
    const y = rect.top + rect.height * (1 - share(value));
    pen.line([[left + wide, y], [left + wide + 4, y]], { colour: theme.faint, width: 1 });
    pen.text(left + wide + 6, y + 0.35 * size, words[i], { colour: theme.ink, size, align: "left" });
  });
  pen.text(left, rect.top - 0.6 * size, name, { colour: theme.ink, size, align: "left" });
};

const barTicks = (colours, most) => {
  const { kind, top } = colours;
  if (!(top > 0)) return { values: [], words: [], share: () => 0 };
  if (kind === "log") {
    const power = Math.floor(Math.log10(top));
    const powers = Array.from({ length: DECADES }, (_, i) => power - i);
    const every = Math.max(1, Math.ceil(DECADES / Math.max(most, 1)));
    const shown = powers.filter((_, i) => i % every === 0);
    const words = shown.map((power) => (power === 0 ? "1" : `10^{${String(power).replace("-", "−")}}`));
    return { values: shown.map((power) => 10 ** power), words, share: shareOf(colours) };
  }
  const found = ticks(kind === "difference" ? -top : 0, top, most);
  return { values: found.values, words: tickWords(found), share: shareOf(colours) };
};

/** Room that a bar of colours needs to the right. */
const roomForBar = (colours, height, size) => {
  const { words } = barTicks(colours, height / (2.6 * size));
  return 10 + 12 + 8 + Math.max(...words.map((word) => textWidth(word, size)), 2 * size);
};

/** The number of the cell in which a value lies; -1 outside. */
const cellOf = (edges, value) => {
  if (!(value >= edges[0] && value <= edges[edges.length - 1])) return -1;
  let low = 0;
  let high = edges.length - 2;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (edges[middle] <= value) low = middle;
    else high = middle - 1;
  }
  return low;
};

const centres = (edges) => Array.from({ length: edges.length - 1 }, (_, i) => 0.5 * (edges[i] + edges[i + 1]));

/** The sign of a feature: a full disc for a peak, a cross for a valley or saddle, a circle for a crater, two for a ring. */
const drawMark = (pen, kind, x, y, { colour, halo, radius, alpha = 1 }) => {
  const round = (r) => Array.from({ length: 25 }, (_, i) => [x + r * Math.cos((i * Math.PI) / 12), y + r * Math.sin((i * Math.PI) / 12)]);
  const line = (points) => {
    pen.line(points, { colour: halo, width: 4, alpha });
    pen.line(points, { colour, width: 2, alpha });
  };
  if (kind === "peak") pen.area(round(radius), { colour, alpha, edge: halo, width: 1.5 });
  else if (kind === "valley") {
    line([[x - radius, y - radius], [x + radius, y + radius]]);
    line([[x - radius, y + radius], [x + radius, y - radius]]);
  } else if (kind === "crater") line(round(1.3 * radius));
  else {
    line(round(1.8 * radius));
    line(round(0.7 * radius));
  }
};

