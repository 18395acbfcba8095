/* Keys for the Studio under the pointer, or else for the one that has the focus.
 *
 * Model   bindings: {key: CSS selector of a button within the Studio}; keys as "p", "delete", "ctrl+shift+z" (ctrl is also
 *         the Mac's command key).
 * Sends nothing: a key clicks the button, so that a key and a click are one thing.
 *
 * Where the user is typing (a cell's editor, a text field) no key is taken, even under the pointer, nor the key of a button
 * that this Studio lacks or does not show now; a key that is taken is kept from the notebook, where z would undo a cell operation.
 */

const STUDIO = ".sketchwidget-studio";

function combination(event) {
  const key = event.key.toLowerCase();
  if (event.altKey || key === "control" || key === "shift" || key === "meta") return "";
  const ctrl = event.ctrlKey || event.metaKey;
  return (ctrl ? "ctrl+" : "") + (ctrl && event.shiftKey ? "shift+" : "") + key;
}

function typing() {
  const focused = document.activeElement;
  if (focused?.matches?.("input[type=range], input[type=checkbox], input[type=button]")) return false;
  return focused?.isContentEditable || /^(INPUT|TEXTAREA|SELECT)$/.test(focused?.tagName ?? "");
}

function studioMeant() {
  return document.querySelector(`${STUDIO}:hover`) ?? document.activeElement?.closest(STUDIO);
}

function render({ model, el }) {
  el.style.display = "none";

  function press(event) {
    const studio = el.closest(STUDIO);
    if (!studio || typing() || studioMeant() !== studio) return;
    const selector = model.get("bindings")[combination(event)];
    const button = selector && [...studio.querySelectorAll(selector)].find((made) => made.offsetParent);
    if (!button) return; // none, or one that is not on show
    event.preventDefault();
    event.stopImmediatePropagation();
    button.click();
  }

  window.addEventListener("keydown", press, { capture: true });
  return () => window.removeEventListener("keydown", press, { capture: true });
}

export default { render };
