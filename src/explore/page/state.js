// What is shown stands in the address, so that a link returns to it; and what is shown leaves the page as files.

const readAddress = () => Object.fromEntries(new URLSearchParams(location.hash.slice(1)));

const writeAddress = (state) => {
  const entries = Object.entries(state).filter(([, value]) => value !== null && value !== undefined && value !== "" && value !== false);
  const text = `#${new URLSearchParams(entries)}`;
  if (text === location.hash) return;
  try {
    history.replaceState(null, "", text);
  } catch (error) {
    // Some browsers allow this a hundred times in half a minute; the next change writes it.
  }
};

const copy = async (text) => {
  try {
    await navigator.clipboard.writeText(text);
  } catch (error) {
    const area = make("textarea", { class: "hidden", "aria-hidden": "true" });
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
};

const save = (name, type, content) => {
  const address = URL.createObjectURL(content instanceof Blob ? content : new Blob([content], { type }));
  const link = make("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
};

/** A density as a table: places, value, and half-width of the band. */
const densityCsv = (scene, observable, density) => {
  const names = observable.axes.map((axis) => scene.axes[axis].name);
  const { values, band } = density;
  const [xs, ys] = observable.centres;
  const lines = [[...names, observable.field === null ? "density" : observable.name, ...(band ? ["band"] : [])].join(",")];
  for (let at = 0; at < values.length; at++) {
    const place = ys ? [xs[Math.floor(at / ys.length)], ys[at % ys.length]] : [xs[at]];
    lines.push([...place, values[at], ...(band ? [band[at]] : [])].join(","));
  }
  return `${lines.join("\n")}\n`;
};

/** The features of one watched density along the sweep. */
const featuresCsv = (scene, source, k) => {
  const names = source.observables[k].axes.map((axis) => scene.axes[axis].name);
  const lines = [[scene.swept.name, "kind", ...names, "density", "persistence", "certain"].join(",")];
  for (const frame of source.frames) {
    for (const mark of frame.found[k]?.features ?? []) {
      lines.push([frame.value, mark.kind, ...mark.at, mark.density, mark.persistence, mark.certain].join(","));
    }
  }
  return `${lines.join("\n")}\n`;
};

