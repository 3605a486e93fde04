// Two pens with the same strokes: one draws on a canvas, one writes SVG. Lengths are in pixels of the page.

const FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif";

/** Widths of the runs of a piece of markup, as a canvas measures them. */
const measuring = document.createElement("canvas").getContext("2d");
const runSize = (script, size) => (script ? 0.75 * size : size);
const layOut = (markup, size) => {
  let at = 0;
  const laid = runs(markup).map(({ text, script }) => {
    measuring.font = `${runSize(script, size)}px ${FONT}`;
    const run = { text, at, size: runSize(script, size), rise: script === "_" ? 0.25 * size : script === "^" ? -0.38 * size : 0 };
    at += measuring.measureText(text).width;
    return run;
  });
  return { runs: laid, width: at };
};
const textWidth = (markup, size) => layOut(markup, size).width;
const anchorShift = (align, width) => (align === "right" ? -width : align === "left" ? 0 : -0.5 * width);

/** Pixels of an image at most: more take longer to compute than a picture of the screen lasts. */
const MOST_PIXELS = 600000;

class CanvasPen {
  /** A pen on a canvas that it clears, unless it is to draw `over` what is there. */
  constructor(canvas, width, height, scale, over = false) {
    this.scale = scale;
    this.context = canvas.getContext("2d");
    if (over) return;
    canvas.width = Math.max(1, Math.round(width * scale));
    canvas.height = Math.max(1, Math.round(height * scale));
    this.context.setTransform(scale, 0, 0, scale, 0, 0);
    this.context.clearRect(0, 0, width, height);
  }

  clipped(rect, draw) {
    this.context.save();
    this.context.beginPath();
    this.context.rect(rect.left, rect.top, rect.width, rect.height);
    this.context.clip();
    draw();
    this.context.restore();
  }

  path(points, closed) {
    this.context.beginPath();
    points.forEach(([x, y], i) => (i ? this.context.lineTo(x, y) : this.context.moveTo(x, y)));
    if (closed) this.context.closePath();
  }

  line(points, { colour, width = 1.5, dash = [], alpha = 1 }) {
    const { context } = this;
    context.globalAlpha = alpha;
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.lineJoin = "round";
    context.setLineDash(dash);
    this.path(points);
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = 1;
  }

  /** Many short lines at once, each of four numbers. */
  segments(numbers, { colour, width = 1 }) {
    const { context } = this;
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.beginPath();
    for (let i = 0; i < numbers.length; i += 4) {
      context.moveTo(numbers[i], numbers[i + 1]);
      context.lineTo(numbers[i + 2], numbers[i + 3]);
    }
    context.stroke();
  }

  area(points, { colour, alpha = 1, edge = null, width = 1 }) {
    const { context } = this;
    context.globalAlpha = alpha;
    context.fillStyle = colour;
    this.path(points, true);
    context.fill();
    if (edge) {
      context.strokeStyle = edge;
      context.lineWidth = width;
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  text(x, y, markup, { colour, size, align = "centre", turned = false, halo = null }) {
    const { context } = this;
    const { runs: laid, width } = layOut(markup, size);
    context.save();
    context.translate(x, y);
    if (turned) context.rotate(-Math.PI / 2);
    context.textBaseline = "alphabetic";
    const shift = anchorShift(align, width);
    for (const run of laid) {
      context.font = `${run.size}px ${FONT}`;
      if (halo) {
        context.strokeStyle = halo;
        context.lineWidth = 3;
        context.lineJoin = "round";
        context.strokeText(run.text, shift + run.at, run.rise);
      }
      context.fillStyle = colour;
      context.fillText(run.text, shift + run.at, run.rise);
    }
    context.restore();
  }

  /** An image whose pixels `fill` computes: as many as the screen has, unless those are more than an eye tells apart. */
  image(rect, fill) {
    const dense = Math.min(this.scale, Math.sqrt(MOST_PIXELS / Math.max(rect.width * rect.height, 1)));
    const columns = Math.max(1, Math.round(rect.width * dense));
    const rows = Math.max(1, Math.round(rect.height * dense));
    const canvas = pixels(columns, rows, fill);
    this.context.imageSmoothingEnabled = false;
    this.context.drawImage(canvas, rect.left, rect.top, rect.width, rect.height);
  }
}

/** A canvas with pixels that `fill(pixels, columns, rows)` computes. */
const pixels = (columns, rows, fill) => {
  const canvas = document.createElement("canvas");
  canvas.width = columns;
  canvas.height = rows;
  const context = canvas.getContext("2d");
  const image = context.createImageData(columns, rows);
  fill(new Uint32Array(image.data.buffer), columns, rows);
  context.putImageData(image, 0, 0);
  return canvas;
};

const xml = (text) => text.replace(/[&<>"]/g, (letter) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;" })[letter]);
const short = (value) => String(Math.round(value * 100) / 100);

class SvgPen {
  constructor(width, height, paper) {
    this.parts = [
      `<svg xmlns="http://www.w3.org/2000/svg" width="${short(width)}" height="${short(height)}" `
        + `viewBox="0 0 ${short(width)} ${short(height)}" font-family="${xml(FONT)}">`,
      `<rect width="100%" height="100%" fill="${paper}"/>`,
    ];
    this.clips = 0;
  }

  clipped({ left, top, width, height }, draw) {
    const id = `clip${this.clips++}`;
    this.parts.push(`<clipPath id="${id}"><rect x="${short(left)}" y="${short(top)}" width="${short(width)}" `
      + `height="${short(height)}"/></clipPath><g clip-path="url(#${id})">`);
    draw();
    this.parts.push("</g>");
  }

  line(points, { colour, width = 1.5, dash = [], alpha = 1 }) {
    const places = points.map(([x, y]) => `${short(x)},${short(y)}`).join(" ");
    const dashes = dash.length ? ` stroke-dasharray="${dash.join(" ")}"` : "";
    this.parts.push(`<polyline points="${places}" fill="none" stroke="${colour}" stroke-width="${width}" `
      + `stroke-linejoin="round" opacity="${alpha}"${dashes}/>`);
  }

  segments(numbers, { colour, width = 1 }) {
    let path = "";
    for (let i = 0; i < numbers.length; i += 4) {
      path += `M${short(numbers[i])} ${short(numbers[i + 1])}L${short(numbers[i + 2])} ${short(numbers[i + 3])}`;
    }
    if (path) this.parts.push(`<path d="${path}" fill="none" stroke="${colour}" stroke-width="${width}"/>`);
  }

  area(points, { colour, alpha = 1, edge = null, width = 1 }) {
    const places = points.map(([x, y]) => `${short(x)},${short(y)}`).join(" ");
    const stroke = edge ? ` stroke="${edge}" stroke-width="${width}"` : "";
    this.parts.push(`<polygon points="${places}" fill="${colour}" opacity="${alpha}"${stroke}/>`);
  }

  text(x, y, markup, { colour, size, align = "centre", turned = false, halo = null }) {
    const { runs: laid, width } = layOut(markup, size);
    const shift = anchorShift(align, width);
    const around = halo ? ` paint-order="stroke" stroke="${halo}" stroke-width="3" stroke-linejoin="round"` : "";
    const turn = turned ? " rotate(-90)" : "";
    const words = laid.map((run) => `<tspan x="${short(shift + run.at)}" y="${short(run.rise)}" `
      + `font-size="${short(run.size)}">${xml(run.text)}</tspan>`).join("");
    this.parts.push(`<text transform="translate(${short(x)} ${short(y)})${turn}" fill="${colour}"${around}>${words}</text>`);
  }

  image({ left, top, width, height }, fill) {
    const canvas = pixels(Math.max(1, Math.round(2 * width)), Math.max(1, Math.round(2 * height)), fill);
    this.parts.push(`<image x="${short(left)}" y="${short(top)}" width="${short(width)}" height="${short(height)}" `
      + `preserveAspectRatio="none" href="${canvas.toDataURL("image/png")}"/>`);
  }

  finish() {
    return `${this.parts.join("\n")}\n</svg>\n`;
  }
}

