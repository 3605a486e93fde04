// What a live page asks its server for, and the frames that it makes of the answers.

/** What the server would not do, in its words. */
class Refused extends Error {}

const doubles = (text) => new Float64Array(fromBase64(text).buffer);

class LiveSource {
  constructor(told) {
    this.told = told;
    this.frames = [];
    this.observables = told.observables.map((one, k) => new Observable(one, told.axes, told.arrays[k].edges));
    this.tops = told.observables.map(() => 0);
    this.bands = [];
    this.grids = new Map();
    this.tickets = 0;
    this.client = Math.random().toString(36).slice(2);
  }

  bandIs(k) {
    return this.bands[k];
  }

  /** Asks the server; nothing where a newer request has taken the place of this one. */
  async ask(path, lane, body) {
    const ticket = ++this.tickets;
    const request = {
      method: "POST", headers: { "content-type": "application/json" },
      body: JSON.stringify(lane === null ? body : { lane: `${this.client}-${lane}`, ticket, ...body }),
    };
    for (let attempt = 0; ; attempt++) {
      let response;
      try {
        response = await fetch(path, request);
      } catch (error) {
        if (attempt >= 2) throw new Refused("The server does not answer. If it was stopped, start pbif explore again and open the address that it prints.");
        await new Promise((resolve) => setTimeout(resolve, 300 * (attempt + 1)));
        continue;
      }
      const text = await response.text();
      if (!response.ok) throw new Refused(text);
      const { done, refused } = JSON.parse(text);
      if (refused !== undefined) throw new Refused(refused);
      return done ?? null;
    }
  }

  /** A frame of the page from an answer; its value is that of the swept parameter, whichever moved. */
  frame(answer, value) {
    const densities = answer.arrays.map((grid, k) => {
      const observable = this.grid(k, grid.edges);
      this.bands[k] = grid.band_is;
      return { grid: observable, values: grid.values && doubles(grid.values), band: grid.band && doubles(grid.band) };
    });
    return { ...answer.frame, value, index: -1, densities };
  }

  /** The cells of a watched density, the same object for the same cells. */
  grid(k, edges) {
    const key = `${k} ${edges.map((axis) => [axis.length, axis[0], axis[1], axis[axis.length - 1]].join(" ")).join(" ")}`;
    if (!this.grids.has(key)) this.grids.set(key, new Observable(this.told.observables[k], this.told.axes, edges));
    return this.grids.get(key);
  }

  nearest(value) {
    let best = 0;
    this.frames.forEach((frame, i) => {
      if (Math.abs(frame.value - value) < Math.abs(this.frames[best].value - value)) best = i;
    });
    return best;
  }
}

