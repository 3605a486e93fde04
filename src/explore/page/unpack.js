// Values of a sweep from their packed form. The arithmetic is that of `src/explore/pack.rs`, operation by operation.

const fromBase64 = (text) => Uint8Array.from(atob(text.trim()), (letter) => letter.charCodeAt(0));

/** The inflated content of a block of the page, which is a zlib stream (RFC 1950). */
const readBlock = async (id) => {
  const bytes = fromBase64(document.getElementById(id).textContent);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

/** Packed values of all frames; `frame` gives those of one. */
class Packed {
  /** `stated` says how the inflated `bytes` are packed, `at` gives the parameter of every frame. */
  constructor(stated, bytes, at) {
    const { levels, cells } = stated;
    const count = at.length * cells;
    const bits = Math.floor(Math.log2(levels)) + 1;
    const width = Math.ceil((bits + 4) / 8);
    if (bytes.length !== count * width) throw new Error("the packed values are damaged");
    this.stated = stated;
    this.steps = new Int32Array(count);
    for (let frame = 0; frame < at.length; frame++) {
      const ratio = lineRatio(at, frame);
      const here = frame * cells;
      for (let cell = 0; cell < cells; cell++) {
        let code = 0;
        for (let plane = 0; plane < width; plane++) code |= bytes[plane * count + here + cell] << (8 * plane);
        const distance = (code >>> 1) ^ -(code & 1);
        this.steps[here + cell] = distance + this.guess(frame, here + cell, cells, ratio);
      }
    }
  }

  guess(frame, at, cells, ratio) {
    if (frame === 0) return 0;
    const last = this.steps[at - cells];
    if (ratio === 0) return last;
    const slope = last - this.steps[at - 2 * cells];
    return last + Math.floor(slope * ratio + 0.5);
  }

  /** The values of a frame. */
  frame(number) {
    const { top, levels, scale, cells } = this.stated;
    const values = new Float64Array(cells);
    for (let cell = 0; cell < cells; cell++) {
      const share = this.steps[number * cells + cell] / levels;
      values[cell] = (scale === "root" ? share * Math.abs(share) : share) * top;
    }
    return values;
  }
}

/** How far the line through the two frames before is followed, in units of their distance. */
const lineRatio = (at, frame) => {
  if (frame < 2) return 0;
  const ratio = (at[frame] - at[frame - 1]) / (at[frame - 1] - at[frame - 2]);
  return ratio > 0 && ratio <= 2 ? ratio : 0;
};

