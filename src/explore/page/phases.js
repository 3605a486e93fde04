// Phases of a forcing: of all densities at phases those at one, which a slider moves, or time.

/** Milliseconds that a period takes to run. */
const PERIOD = 3000;

class Phases {
  constructor(page) {
    const phases = page.source.observables.map(({ phase }) => phase).filter((phase) => phase !== null);
    Object.assign(this, { page, all: [...new Set(phases)].sort((a, b) => a - b), place: 0, timer: null });
    $("phase-row").hidden = this.all.length < 2;
    $("phase").max = String(this.all.length - 1);
    if (this.all.length > 1) this.show(0);
  }

  /** Shows the densities at the phase of a number; after the last one comes the first. */
  show(place) {
    const { page, all } = this;
    this.place = ((place % all.length) + all.length) % all.length;
    const { observables } = page.source;
    const isHidden = (k) => observables[k].phase !== null && observables[k].phase !== all[this.place];
    for (const k of page.singles) $(`marginal-${k}`).closest("figure").hidden = isHidden(k);
    const joint = observables[page.k.joint];
    if (joint && isHidden(page.k.joint)) {
      const same = (k) => !isHidden(k) && String(observables[k].states) === String(joint.states) && observables[k].phase !== null;
      page.k.joint = page.joints.find(same) ?? page.k.joint;
      $("joint-choice").value = String(page.k.joint);
    }
    $("phase").value = String(this.place);
    const words = `${plainNumber(all[this.place], 4)} of the period`;
    $("phase-says").textContent = words;
    $("phase").setAttribute("aria-valuetext", words);
    page.later();
  }

  run(on = this.timer === null) {
    if (this.timer !== null) clearInterval(this.timer);
    this.timer = on ? setInterval(() => this.show(this.place + 1), Math.max(30, PERIOD / this.all.length)) : null;
    $("run").setAttribute("aria-pressed", String(on));
    $("run").textContent = on ? "Stop" : "Run";
  }
}

/** What the controls of the phase do. */
const connectPhases = (page) => {
  const phases = new Phases(page);
  if (phases.all.length < 2) return;
  $("phase").addEventListener("input", () => phases.show(Number($("phase").value)));
  $("run").addEventListener("click", () => phases.run());
};
