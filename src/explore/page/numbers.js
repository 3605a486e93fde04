// Numbers and symbols as people read them.

const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** A number with so many significant digits, a true minus sign and no needless zeros. */
const number = (value, digits = 4) => {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const magnitude = Math.abs(value);
  let text = magnitude < 1e-4 || magnitude >= 1e6 ? value.toExponential(digits - 1) : value.toPrecision(digits);
  if (text.includes("e") && magnitude >= 1e-4 && magnitude < 1e6) text = String(Number(text));
  text = text.replace(/(\.\d*?)0+(?=e|$)/, "$1").replace(/\.(?=e|$)/, "");
  return text.replace(/^-/, "−").replace(/e([+-])(\d+)/, (_, sign, power) => ` × 10^{${sign === "-" ? "−" : ""}${power}}`);
};

/** The same without markup: powers in superscript letters. */
const plainNumber = (value, digits) => plain(number(value, digits));

/** A value with its error: as many digits as the error leaves. */
const withError = (value, error) => {
  if (!(error > 0)) return plainNumber(value, 6);
  const place = Math.floor(Math.log10(error)) - 1;
  if (place < -15 || place > 3) return `${plainNumber(value, 6)} ± ${plainNumber(error, 2)}`;
  const decimals = Math.max(0, -place);
  const exact = Math.abs(value) < 0.5 * 10 ** -decimals ? 0 : value;
  if (decimals > 8) return `${plainNumber(exact, 6)} ± ${plainNumber(error, 2)}`;
  return `${exact.toFixed(decimals).replace("-", "−")} ± ${error.toFixed(decimals)}`;
};

const RAISED = { "−": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };
const raised = (text) => [...text].map((letter) => RAISED[letter] ?? letter).join("");

/** Markup taken apart: `_{…}` lowers, `^{…}` raises. */
const runs = (markup) => {
  const parts = [];
  const pattern = /([_^])\{([^}]*)\}|([^_^]+|[_^])/g;
  for (const [, script, inner, text] of markup.matchAll(pattern)) {
    if (script) parts.push({ text: inner, script });
    else parts.push({ text, script: "" });
  }
  return parts;
};

/** Markup as plain letters. */
const plain = (markup) =>
  runs(markup).map(({ text, script }) => (script === "^" ? raised(text) : script === "_" ? `_${text}` : text)).join("");

/** Markup as nodes of the page. */
const nodes = (markup) => runs(markup).map(({ text, script }) => {
  if (!script) return document.createTextNode(text);
  const node = document.createElement(script === "_" ? "sub" : "sup");
  node.textContent = text;
  return node;
});

/** Round values within a range, at most so many of them. */
const ticks = (from, to, most) => {
  const rough = (to - from) / Math.max(most, 1);
  if (!(rough > 0)) return { values: [from], decimals: 2 };
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 2.5, 5, 10].find((factor) => factor * power >= rough * (1 - 1e-9));
  const first = Math.ceil(from / step - 1e-9);
  const last = Math.floor(to / step + 1e-9);
  const values = [];
  for (let i = first; i <= last; i++) values.push(i === 0 ? 0 : Number((i * step).toPrecision(12)));
  return { values, step };
};

/** The next number above that a person would end an axis with. */
const roundUp = (value) => {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 1.5, 2, 3, 4, 5, 6, 8, 10].find((factor) => factor * power >= value * (1 - 1e-9)) ?? 10);
};

/** What stands beside the ticks: all with the same decimals, or as powers. */
const tickWords = ({ values, step }) => {
  const largest = Math.max(...values.map(Math.abs), 0);
  if (step === undefined || largest === 0) return values.map((value) => number(value, 3));
  if (largest >= 1e5 || largest < 1e-3) return values.map((value) => number(value, 3));
  const decimals = clamp(Math.ceil(-Math.log10(step) + (/2\.5|25/.test(String(step)) ? 1 : 0) - 1e-9), 0, 8);
  return values.map((value) => value.toFixed(decimals).replace("-", "−"));
};

