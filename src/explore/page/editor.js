// The editor of a live page: the sweep file of the system that is shown, or one of the gallery, as text. What it makes is shown at an
// address of its own.

class Editor {
  constructor(page) {
    this.page = page;
    this.starts = null;
    $("editor-text").value = page.scene.typed;
  }

  open() {
    $("editor").showModal();
    const text = $("editor-text");
    text.focus();
    // The caret of a text that was filled in stands at its end.
    if (text.selectionStart === text.value.length) text.setSelectionRange(0, 0);
    text.scrollTop = 0;
    if (!this.starts) this.list();
  }

  /** Lists the systems of the gallery. */
  async list() {
    try {
      this.starts = await this.page.source.ask("starts", null, {});
      $("editor-start").append(...this.starts.map(({ name, title }) => make("option", { value: name }, title)));
    } catch (error) {
      this.refuse(error);
    }
  }

  /** Puts the text of a system of the gallery, or of the one that is shown, in the place of what stands there. */
  begin(name) {
    const text = $("editor-text");
    text.value = this.starts?.find((start) => start.name === name)?.text ?? this.page.scene.typed;
    text.setSelectionRange(0, 0);
    text.scrollTop = 0;
    $("editor-says").textContent = "";
  }

  /** Shows the system that the text makes. What is shown of this one, as far as the new one has it, is shown of that. */
  async show() {
    const button = $("editor-show");
    $("editor-says").textContent = "";
    button.textContent = "Solving…";
    try {
      const answer = await this.page.source.ask("edit", "edit", { text: $("editor-text").value });
      if (answer) {
        const [, token] = location.pathname.split("/");
        location.assign(`/${token}/${answer.folder}${location.hash}`);
      }
    } catch (error) {
      this.refuse(error);
    }
    button.textContent = "Show";
  }

  /** Says why there is no such system, and goes to the first place that is blamed. */
  refuse(error) {
    if (!(error instanceof Refused)) throw error;
    $("editor-says").textContent = error.message;
    const text = $("editor-text");
    const place = error.message.match(/--> \S+:(\d+):(\d+)/);
    if (!place) return;
    const lines = text.value.split("\n");
    const [line, column] = [Number(place[1]) - 1, Number(place[2]) - 1];
    const before = lines.slice(0, line).reduce((sum, one) => sum + one.length + 1, 0);
    text.focus();
    text.setSelectionRange(before + column, before + (lines[line] ?? "").length);
    text.scrollTop = (text.scrollHeight / lines.length) * Math.max(0, line - 5);
  }

  save() {
    save("system.toml", "application/toml", $("editor-text").value);
  }
}

/** What the controls of the editor do. */
const connectEditor = (page) => {
  const editor = new Editor(page);
  $("edit").hidden = false;
  $("edit").addEventListener("click", () => editor.open());
  $("editor-start").addEventListener("change", () => editor.begin($("editor-start").value));
  $("editor-show").addEventListener("click", () => editor.show());
  $("editor-save").addEventListener("click", () => editor.save());
  $("editor-close").addEventListener("click", () => $("editor").close());
  $("editor-text").addEventListener("keydown", (event) => {
    if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey)) return;
    event.preventDefault();
    editor.show();
  });
};
