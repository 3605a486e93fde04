// Contour lines of values on cells, by marching squares over the centres of the cells.

/** Short lines where the values cross a level, four numbers each, in pixels: `xs` and `ys` place the centres. */
const contour = (values, xs, ys, level) => {
  const lines = [];
  const [columns, rows] = [xs.length, ys.length];
  for (let i = 0; i + 1 < columns; i++) {
    for (let j = 0; j + 1 < rows; j++) {
      const at = i * rows + j;
      // Corners in turn: (i, j), (i+1, j), (i+1, j+1), (i, j+1).
      const a = values[at];
      const b = values[at + rows];
      const c = values[at + rows + 1];
      const d = values[at + 1];
      const code = (a > level) | ((b > level) << 1) | ((c > level) << 2) | ((d > level) << 3);
      if (code === 0 || code === 15) continue;
      const edges = [
        () => [xs[i] + (xs[i + 1] - xs[i]) * ((level - a) / (b - a)), ys[j]],
        () => [xs[i + 1], ys[j] + (ys[j + 1] - ys[j]) * ((level - b) / (c - b))],
        () => [xs[i] + (xs[i + 1] - xs[i]) * ((level - d) / (c - d)), ys[j + 1]],
        () => [xs[i], ys[j] + (ys[j + 1] - ys[j]) * ((level - a) / (d - a))],
      ];
      for (const [from, to] of crossed(code, a + b + c + d > 4 * level)) lines.push(...edges[from](), ...edges[to]());
    }
  }
  return lines;
};

/** Pairs of edges (0 below, 1 right, 2 above, 3 left) that a contour joins. `high`: the middle of the square lies above the level. */
const crossed = (code, high) => {
  switch (code) {
    case 1: case 14: return [[3, 0]];
    case 2: case 13: return [[0, 1]];
    case 3: case 12: return [[3, 1]];
    case 4: case 11: return [[1, 2]];
    case 6: case 9: return [[0, 2]];
    case 7: case 8: return [[2, 3]];
    case 5: return high ? [[3, 2], [0, 1]] : [[3, 0], [1, 2]];
    case 10: return high ? [[3, 0], [1, 2]] : [[3, 2], [0, 1]];
    default: return [];
  }
};

