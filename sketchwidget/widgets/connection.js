/* Tells on the page that the kernel behind a Studio is gone: from then on nothing there can follow the pen.
 *
 * Model   kept: the file that holds what was drawn, empty if there is none.
 * Class   "sketchwidget-gone" on the Studio, whose status line gives way to this one.
 *
 * JupyterLab, Notebook 7 and Voila tell by the status of the kernel, other front ends by their widgets' comms at most.
 */

const ENDED = ["restarting", "autorestarting", "terminating", "dead"];
const DISCONNECTED = "jupyter-widgets-disconnected"; // of the front end's own, on all views without a kernel

function render({ model, el }) {
  el.classList.add("sketchwidget-farewell");
  el.setAttribute("role", "status");

  function gone() {
    const studio = el.closest(".sketchwidget-studio");
    if (!studio || studio.classList.contains("sketchwidget-gone")) return;
    studio.classList.add("sketchwidget-gone");
    const kept = model.get("kept");
    el.textContent = "The kernel has ended, and this Studio follows no more. ";
    if (!kept) {
      el.append("Run its cell again, or reload a page without code, for a new one.");
      return;
    }
    const code = document.createElement("code");
    code.textContent = `sw.Studio(sw.Session.load(${JSON.stringify(kept)}))`;
    el.append("What was drawn is kept: to go on from it, run ", code, " in a cell.");
  }

  const onStatus = (_, status) => ENDED.includes(status) && gone();
  const onComm = ({ comm_live: live }) => live || gone();

  const kernel = model.widget_manager.kernel ?? null;
  kernel?.statusChanged?.connect(onStatus);
  kernel?.disposed?.connect(gone);
  model.on("comm_live_update", onComm);
  requestAnimationFrame(() => el.classList.contains(DISCONNECTED) && gone()); // a saved page, opened without its kernel

  return () => {
    kernel?.statusChanged?.disconnect(onStatus);
    kernel?.disposed?.disconnect(gone);
    model.off("comm_live_update", onComm);
  };
}

export default { render };
