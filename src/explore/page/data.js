// The data of the page: what it was told once, and its frames, one a value of the parameter.

/** A watched density: its cells, and where it is worth looking at. */
class Observable {
  constructor(told, axes, edges) {
    Object.assign(this, { name: told.name, axes: told.axes, phase: told.phase ?? null, states: told.states, edges });
    this.symbols = told.axes.map((axis) => axes[axis].symbol);
    this.joint = told.axes.length === 2;
    // A field of a passage over the state is no density, and nothing is counted in it.
    this.field = told.field ?? null;
    this.title = this.field ?? `p(${this.symbols.join(", ")})`;
    this.centres = edges.map(centres);
    this.volumes = volumes(edges);
  }
}

/** Sizes of the cells, the last axis fastest. */
const volumes = (edges) => {
  let found = [1];
  for (const axis of edges) {
    found = found.flatMap((volume) => centres(axis).map((_, i) => volume * (axis[i + 1] - axis[i])));
  }
  return found;
};

/** Hellinger distance √(½ Σ (√p − √q)²) of two densities on the same cells. */
const hellinger = (p, q, volume) => {
  const root = (value, cell) => Math.sqrt(Math.max(value, 0) * volume[cell]);
  let sum = 0;
  for (let cell = 0; cell < p.length; cell++) sum += (root(p[cell], cell) - root(q[cell], cell)) ** 2;
  return Math.sqrt(0.5 * sum);
};

const largest = (values) => {
  let top = 0;
  for (const value of values) if (value > top) top = value;
  return top;
};

/** The densities among what a page shows; fields of passages stand behind them. */
const densitiesOf = (source) => source.observables.filter(({ field }) => field === null);

/** Frames of a finished sweep, all in the page. */
class StoredSource {
  static async load(told) {
    const source = new this();
    source.frames = told.frames.map((frame, index) => ({ ...frame, index, densities: [] }));
    source.values = source.frames.map((frame) => frame.value);
    source.arrays = await Promise.all(told.arrays.map((arrays) => source.unpack(arrays)));
    source.observables = told.observables.map((one, k) => new Observable(one, told.axes, told.arrays[k].edges));
    source.tops = source.arrays.map((arrays) => (arrays.values ? arrays.values.stated.top : 0));
    source.arrays.forEach((arrays, k) => arrays.frames.forEach((index, row) => {
      source.frames[index].densities[k] = source.lazily(arrays, row);
    }));
    return source;
  }

  async unpack(arrays) {
    const at = arrays.frames.map((index) => this.values[index]);
    const packed = async (stated) => stated && new Packed(stated, await readBlock(`block-${stated.block}`), at);
    return {
      frames: arrays.frames,
      values: await packed(arrays.values),
      band: await packed(arrays.band),
      bandIs: arrays.band_is,
    };
  }

  /** What the band of a marginal is, in words; nothing where it has none. */
  bandIs(k) {
    return this.arrays[k].bandIs;
  }

  /** The values of one density, computed when first asked for. */
  lazily(arrays, row) {
    let kept = null;
    const density = {
      get values() {
        if (arrays.values.stated.cells <= 1024) kept ??= arrays.values.frame(row);
        return kept ?? arrays.values.frame(row);
      },
      get band() {
        return arrays.band ? arrays.band.frame(row) : null;
      },
      bandIs: arrays.bandIs,
    };
    return density;
  }

  /** The number of the frame nearest to a value. */
  nearest(value) {
    let low = 0;
    let high = this.values.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (this.values[middle] <= value) low = middle;
      else high = middle;
    }
    return Math.abs(this.values[low] - value) <= Math.abs(this.values[high] - value) ? low : high;
  }
}

/** The part of an axis outside of which a density is nearly empty; computed once. */
const windowOfFrame = (frame, k, axis) => {
  const density = frame.densities[k];
  density.windows ??= [];
  return density.windows[axis] ??= windowOf({ observables: { [k]: density.grid }, tops: { [k]: largest(density.values) }, frames: [frame] }, k, axis);
};

/** The cells on which a frame has a watched density. */
const gridOf = (source, frame, k) => frame?.densities[k]?.grid ?? source.observables[k];

/** The part of an axis of a watched density outside of which all frames are nearly empty. */
const windowOf = (source, k, axis) => {
  const edges = source.observables[k].edges[axis];
  const count = edges.length - 1;
  const inner = source.observables[k].joint && axis === 0 ? source.observables[k].edges[1].length - 1 : 1;
  const limit = 1e-3 * source.tops[k];
  const isEmpty = source.observables[k].field === null ? (value) => value <= limit : (value) => Math.abs(value) <= limit;
  let [first, last] = [count - 1, 0];
  // Of a map all rows count, so that rows can be compared by eye.
  for (const frame of source.all ?? source.frames) {
    const values = frame.densities[k]?.values;
    if (!values) continue;
    for (let at = 0; at < values.length; at++) {
      if (isEmpty(values[at])) continue;
      const cell = Math.floor(at / inner) % count;
      if (cell < first) first = cell;
      if (cell > last) last = cell;
    }
  }
  if (first > last) return [edges[0], edges[count]];
  const border = 0.04 * (edges[last + 1] - edges[first]);
  return [Math.max(edges[0], edges[first] - border), Math.min(edges[count], edges[last + 1] + border)];
};

