// Inflates zlib streams (RFC 1950, RFC 1951): by the browser where it can, else by the decoder below.

/** Bytes of a zlib stream, inflated. */
const inflate = async (bytes) => {
  if (typeof DecompressionStream === "function") {
    try {
      const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
      return new Uint8Array(await new Response(stream).arrayBuffer());
    } catch (error) {
      // A browser that knows the name alone: the decoder below does the same.
    }
  }
  return inflateHere(bytes);
};

/** The same without the browser's help. */
const inflateHere = (bytes) => {
  const out = new Growing(bytes.length * 6);
  const bits = new Bits(bytes, 2);
  for (let last = 0; !last;) {
    last = bits.take(1);
    const kind = bits.take(2);
    if (kind === 0) copyStored(bits, out);
    else if (kind === 1) inflateBlock(bits, out, FIXED_LENGTHS, FIXED_DISTANCES);
    else if (kind === 2) inflateBlock(bits, out, ...readCodes(bits));
    else throw new Error("the packed values are damaged");
  }
  return out.bytes.subarray(0, out.length);
};

/** Bytes that grow. */
class Growing {
  constructor(size) {
    this.bytes = new Uint8Array(Math.max(size, 1024));
    this.length = 0;
  }

  reserve(more) {
    if (this.length + more <= this.bytes.length) return;
    const larger = new Uint8Array(2 * (this.length + more));
    larger.set(this.bytes);
    this.bytes = larger;
  }

  push(byte) {
    this.reserve(1);
    this.bytes[this.length++] = byte;
  }

  /** Repeats what stands so far back. */
  repeat(distance, length) {
    if (distance > this.length) throw new Error("the packed values are damaged");
    this.reserve(length);
    for (let i = 0; i < length; i++, this.length++) this.bytes[this.length] = this.bytes[this.length - distance];
  }
}

/** Bits of a stream, the lowest first. */
class Bits {
  constructor(bytes, at) {
    Object.assign(this, { bytes, at, held: 0, count: 0 });
  }

  take(wanted) {
    while (this.count < wanted) {
      if (this.at >= this.bytes.length) throw new Error("the packed values are damaged");
      this.held |= this.bytes[this.at++] << this.count;
      this.count += 8;
    }
    const value = this.held & ((1 << wanted) - 1);
    this.held >>>= wanted;
    this.count -= wanted;
    return value;
  }
}

/** A prefix code from the lengths of its words: how many words of each length, and the symbols in their order. */
const prefixCode = (lengths) => {
  const counts = new Uint16Array(16);
  for (const length of lengths) counts[length]++;
  counts[0] = 0;
  const starts = new Uint16Array(16);
  for (let length = 1; length < 16; length++) starts[length] = starts[length - 1] + counts[length - 1];
  const symbols = new Uint16Array(lengths.length);
  lengths.forEach((length, symbol) => {
    if (length) symbols[starts[length]++] = symbol;
  });
  return { counts, symbols };
};

const readSymbol = (bits, { counts, symbols }) => {
  let code = 0;
  let first = 0;
  let index = 0;
  for (let length = 1; length < 16; length++) {
    code |= bits.take(1);
    const count = counts[length];
    if (code - count < first) return symbols[index + code - first];
    index += count;
    first = (first + count) << 1;
    code <<= 1;
  }
  throw new Error("the packed values are damaged");
};

const FIXED_LENGTHS = prefixCode(
  Array.from({ length: 288 }, (_, i) => (i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8)));
const FIXED_DISTANCES = prefixCode(Array(30).fill(5));
const ORDER_OF_LENGTHS = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];

/** The two codes of a block that brings its own. */
const readCodes = (bits) => {
  const lengths = bits.take(5) + 257;
  const distances = bits.take(5) + 1;
  const given = bits.take(4) + 4;
  const ofLengths = Array(19).fill(0);
  for (let i = 0; i < given; i++) ofLengths[ORDER_OF_LENGTHS[i]] = bits.take(3);
  const code = prefixCode(ofLengths);
  const words = [];
  while (words.length < lengths + distances) {
    const symbol = readSymbol(bits, code);
    if (symbol < 16) words.push(symbol);
    else {
      const word = symbol === 16 ? words[words.length - 1] : 0;
      const times = symbol === 16 ? 3 + bits.take(2) : symbol === 17 ? 3 + bits.take(3) : 11 + bits.take(7);
      for (let i = 0; i < times; i++) words.push(word);
    }
  }
  return [prefixCode(words.slice(0, lengths)), prefixCode(words.slice(lengths, lengths + distances))];
};

/** Where each symbol of a length or distance begins, and the bits it adds. */
const steps = (first, count, per) => {
  const from = [first];
  const extra = [];
  for (let i = 0; i < count; i++) {
    extra.push(Math.max(0, Math.floor(i / per) - 1));
    from.push(from[i] + (1 << extra[i]));
  }
  return { from, extra };
};
const LENGTHS = steps(3, 28, 4);
LENGTHS.from[28] = 258;
LENGTHS.extra[28] = 0;
const DISTANCES = steps(1, 30, 2);

const inflateBlock = (bits, out, lengths, distances) => {
  for (;;) {
    const symbol = readSymbol(bits, lengths);
    if (symbol === 256) return;
    if (symbol < 256) out.push(symbol);
    else {
      const length = LENGTHS.from[symbol - 257] + bits.take(LENGTHS.extra[symbol - 257]);
      const far = readSymbol(bits, distances);
      out.repeat(DISTANCES.from[far] + bits.take(DISTANCES.extra[far]), length);
    }
  }
};

const copyStored = (bits, out) => {
  bits.held = 0;
  bits.count = 0;
  const length = bits.take(16);
  bits.take(16);
  for (let i = 0; i < length; i++) out.push(bits.take(8));
};

