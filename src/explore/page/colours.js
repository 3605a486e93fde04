// Colours: those of densities, of differences, and those that the page's theme gives.

/** Viridis, as in the figures: perceptually uniform, readable in grey. */
const VIRIDIS = [
  [68, 1, 84], [70, 50, 127], [54, 92, 141], [39, 127, 143], [31, 162, 136], [74, 194, 110], [160, 219, 57], [254, 232, 37],
];
/** Blue, white, red: for differences, readable by the colour-blind. */
const DIVERGING = [
  [5, 48, 97], [33, 102, 172], [67, 147, 195], [146, 197, 222], [209, 229, 240], [247, 247, 247],
  [253, 219, 199], [244, 165, 130], [214, 96, 77], [178, 24, 43], [103, 0, 31],
];

/** 256 colours along the anchors, as pixels of an image (the bytes of a pixel stand in the order of memory). */
const table = (anchors) => {
  const bytes = new Uint8ClampedArray(4 * 256);
  for (let i = 0; i < 256; i++) {
    const place = (i / 255) * (anchors.length - 1);
    const low = Math.min(Math.floor(place), anchors.length - 2);
    for (let channel = 0; channel < 3; channel++) {
      const [a, b] = [anchors[low][channel], anchors[low + 1][channel]];
      bytes[4 * i + channel] = a + (b - a) * (place - low);
    }
    bytes[4 * i + 3] = 255;
  }
  return { pixels: new Uint32Array(bytes.buffer), bytes };
};
const HEAT = table(VIRIDIS);
const DIFFERENCE = table(DIVERGING);

/** Decades that logarithmic colours span. */
const DECADES = 6;

/** From a value to a share between 0 and 1 along the colours. */
const shareOf = ({ kind, top }) => {
  if (!(top > 0)) return () => 0;
  if (kind === "difference") return (value) => 0.5 + (0.5 * value) / top;
  if (kind === "log") return (value) => (value > 0 ? 1 + Math.log10(value / top) / DECADES : 0);
  return (value) => value / top;
};

const coloursOf = ({ kind }) => (kind === "difference" ? DIFFERENCE : HEAT);

/** The colours of the page, from its style. */
const themeColours = () => {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const names = ["ink", "faint", "grid", "paper", "line", "pinned", "mark", "cursor", "empty"];
  return Object.fromEntries(names.map((name) => [name, colour(name)]));
};

