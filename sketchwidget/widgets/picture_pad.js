/* Points on a picture, dragged at the page's own speed.
 *
 * Model   canvas: "IPY_MODEL_<id>" of the ipycanvas Canvas that holds the picture; size: its pixels [width, height], 0 without
 *         one; part: [left, top, side] of the square that the pad shows; points: [x, y] of each; lines: numbers of the points
 *         that each line runs through; clickable: whether clicks beside the points count; invitation: words shown without a
 *         picture.
 * Sends   {type: "move", move: id, number, place: [x, y], done}: a point is dragged, or was let go (done). At most 15 a second,
 *         and until it was let go none before the last one was answered;
 *         {type: "click", place: [x, y]}.
 * Takes   {type: "answer", move: id}: the kernel has answered that move.
 * Class   "sketchwidget-drawing" on the pad's element while a point is dragged.
 *
 * Without a picture, a click on the pad is one on the button `.sketchwidget-do-picture` of the same Studio.
 *
 * All places are pixels of the picture. The wheel zooms once the pad was clicked, as that of the head does; a drag beside the
 * points shifts what was zoomed, a double click shows the part that the kernel chose. The arrow keys move the point that was
 * dragged last.
 */

const MOVE_EVERY = 1000 / 15; // milliseconds
const REACH = { mouse: 0.025, pen: 0.03, touch: 0.06 }; // of the pad's side, about a point
const CLICK = 5; // screen pixels that a click may move
const SMALLEST = 24; // picture pixels that the pad shows
const RADIUS = 0.0075; // of the pad's side
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const STEP = 0.002; // of the pad's side, by an arrow key
const SVG = "http://www.w3.org/2000/svg";
const CANVAS_EVENTS = [
  "mousedown", "mousemove", "mouseup", "mouseout", "wheel", "touchstart", "touchmove", "touchend", "touchcancel", "keydown",
];

function element(name, parent, className) {
  const made = document.createElementNS(SVG, name);
  if (className) made.setAttribute("class", className);
  parent.append(made);
  return made;
}

async function render({ model, el }) {
  const manager = model.widget_manager;
  const canvas = await manager.get_model(model.get("canvas").slice("IPY_MODEL_".length));
  const view = await manager.create_view(canvas);

  const pad = document.createElement("div");
  const words = document.createElement("div");
  const marks = document.createElementNS(SVG, "svg");
  pad.className = "sketchwidget-picture";
  pad.tabIndex = 0;
  pad.setAttribute("role", "application");
  pad.setAttribute("aria-label", "Picture with landmarks");
  words.className = "sketchwidget-invitation";
  const halos = element("g", marks, "sketchwidget-halos");
  const lines = element("g", marks, "sketchwidget-lines");
  const dots = element("g", marks, "sketchwidget-points");
  pad.append(view.el, marks, words);
  el.classList.add("sketchwidget-square");
  el.append(pad);

  let points = [];
  let part = [0, 0, 1];
  let drag = null; // {pointer, number (-1 beside the points), offset, start, from, moved}
  let chosen = -1; // the point that the arrow keys move
  let count = 0;
  let asked = null; // the move that waits for its answer
  let lastAsked = 0;
  const page = Math.random().toString(36).slice(2);

  const clampTo = ([x, y]) => {
    const [width, height] = model.get("size");
    return [Math.min(width, Math.max(0, x)), Math.min(height, Math.max(0, y))];
  };

  /** Where the pointer is, in pixels of the picture. */
  function place(event) {
    const box = pad.getBoundingClientRect();
    const share = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    return share.map((value, axis) => part[axis] + value * part[2]);
  }

  /** The number of the nearest point within reach of the pointer, -1 if there is none. */
  function near(event) {
    const [x, y] = place(event);
    const reach = (REACH[event.pointerType] ?? REACH.mouse) * part[2];
    let found = -1;
    let least = reach;
    points.forEach(([px, py], number) => {
      const away = Math.hypot(px - x, py - y);
      if (away < least) [found, least] = [number, away];
    });
    return found;
  }

  /** Puts picture and marks where the part that is shown has them. */
  function frame() {
    const [left, top, side] = part;
    const [width, height] = model.get("size");
    Object.assign(view.el.style, {
      position: "absolute",
      left: `${(-100 * left) / side}%`,
      top: `${(-100 * top) / side}%`,
      width: `${(100 * width) / side}%`,
      height: `${(100 * height) / side}%`,
      visibility: width ? "" : "hidden",
    });
    marks.setAttribute("viewBox", [...part, side].join(" "));
    words.textContent = model.get("invitation");
    words.hidden = width > 0;
    pad.classList.toggle("sketchwidget-blank", !width);
    for (const dot of dots.children) dot.setAttribute("r", RADIUS * side);
  }

  function paint() {
    const runs = model.get("lines").filter((line) => line.every((number) => number < points.length));
    for (const group of [halos, lines]) {
      while (group.childElementCount > runs.length) group.lastChild.remove();
      while (group.childElementCount < runs.length) element("polyline", group);
      runs.forEach((line, at) => group.children[at].setAttribute("points", line.map((number) => points[number].join(",")).join(" ")));
    }
    while (dots.childElementCount > points.length) dots.lastChild.remove();
    while (dots.childElementCount < points.length) element("circle", dots).setAttribute("r", RADIUS * part[2]);
    points.forEach(([x, y], number) => {
      dots.children[number].setAttribute("cx", x);
      dots.children[number].setAttribute("cy", y);
    });
  }

  function mark(number) {
    [...dots.children].forEach((dot, at) => dot.classList.toggle("sketchwidget-near", at === number));
  }

  /** Shows the kernel's points, once it has answered all moves: before that, they lag behind the hand. */
  function follow() {
    if (asked === null) take();
  }

  function take() {
    const given = model.get("points");
    const held = drag && drag.number >= 0 && drag.number < given.length ? points[drag.number] : null;
    points = given.map((point) => [...point]);
    if (held) points[drag.number] = held;
    paint();
  }

  function followPart() {
    part = [...model.get("part")];
    frame();
  }

  function tell(number, done) {
    const now = performance.now();
    if (!done && (asked !== null || now - lastAsked < MOVE_EVERY)) return;
    asked = `${page}-${count++}`;
    lastAsked = now;
    model.send({ type: "move", move: asked, number, place: points[number], done });
  }

  function down(event) {
    if (drag || !event.isPrimary || event.button !== 0) return;
    event.preventDefault();
    pad.focus({ preventScroll: true });
    if (!model.get("size")[0]) return;
    pad.setPointerCapture(event.pointerId);
    const at = place(event);
    const number = near(event);
    const offset = number < 0 ? [0, 0] : points[number].map((value, axis) => value - at[axis]);
    drag = { pointer: event.pointerId, number, offset, start: [event.clientX, event.clientY], from: [...part], moved: false };
    if (number >= 0) {
      chosen = number;
      mark(number);
      pad.classList.add("sketchwidget-drawing");
    }
  }

  function move(event) {
    if (event.pointerId !== drag?.pointer) {
      if (!drag) hover(event);
      return;
    }
    const away = [event.clientX - drag.start[0], event.clientY - drag.start[1]];
    drag.moved ||= Math.hypot(...away) > (drag.number < 0 ? CLICK : 0);
    if (!drag.moved) return;
    if (drag.number >= 0) {
      points[drag.number] = clampTo(place(event).map((value, axis) => value + drag.offset[axis]));
      paint();
      tell(drag.number, false);
    } else if (part[2] < Math.max(...model.get("size"))) {
      const unit = part[2] / pad.clientWidth;
      part = [drag.from[0] - away[0] * unit, drag.from[1] - away[1] * unit, part[2]];
      frame();
    }
  }

  function hover(event) {
    const number = near(event);
    mark(number);
    pad.classList.toggle("sketchwidget-over", number >= 0);
    pad.classList.toggle("sketchwidget-clickable", model.get("clickable"));
  }

  function up(event) {
    if (event.pointerId !== drag?.pointer) return;
    const { number, moved } = drag;
    drag = null;
    pad.classList.remove("sketchwidget-drawing");
    if (number >= 0) {
      if (moved) tell(number, true);
    } else if (!moved && event.type === "pointerup" && model.get("clickable")) {
      model.send({ type: "click", place: clampTo(place(event)) });
    }
  }

  function cancel(event) {
    if (event.pointerId !== drag?.pointer) return;
    const { number, moved } = drag;
    drag = null;
    pad.classList.remove("sketchwidget-drawing");
    take();
    if (number >= 0 && moved && number < points.length) tell(number, true); // back to where it was
  }

  function zoom(event) {
    if (document.activeElement !== pad || !model.get("size")[0]) return;
    event.preventDefault();
    const [x, y] = place(event);
    const whole = Math.max(...model.get("size"));
    const side = Math.min(whole, Math.max(SMALLEST, part[2] * Math.exp(event.deltaY * 0.0015)));
    const ratio = side / part[2];
    part = [x - (x - part[0]) * ratio, y - (y - part[1]) * ratio, side];
    frame();
  }

  function press(event) {
    const step = ARROWS[event.key];
    if (!step || chosen < 0 || chosen >= points.length || drag) return;
    event.preventDefault();
    event.stopPropagation();
    const unit = STEP * part[2] * (event.shiftKey ? 5 : 1);
    points[chosen] = clampTo(points[chosen].map((value, axis) => value + unit * step[axis]));
    paint();
    tell(chosen, true);
  }

  function answer(message) {
    if (message.type !== "answer" || message.move !== asked) return;
    asked = null;
    follow();
  }

  /** Without a picture, a click is one on the button of the same Studio that opens one. */
  function invite() {
    if (!model.get("size")[0]) el.closest(".sketchwidget-studio")?.querySelector(".sketchwidget-do-picture")?.click();
  }

  for (const type of CANVAS_EVENTS) view.el.addEventListener(type, (event) => event.stopPropagation(), { capture: true });
  pad.addEventListener("pointerdown", down);
  pad.addEventListener("pointermove", move);
  pad.addEventListener("pointerup", up);
  pad.addEventListener("lostpointercapture", up);
  pad.addEventListener("pointercancel", cancel);
  pad.addEventListener("click", invite);
  pad.addEventListener("pointerleave", () => !drag && mark(-1));
  pad.addEventListener("wheel", zoom, { passive: false });
  pad.addEventListener("dblclick", followPart);
  pad.addEventListener("keydown", press);
  model.on("msg:custom", answer);
  model.on("change:points change:lines", follow);
  model.on("change:part change:size change:invitation", followPart);
  followPart();
  follow();

  return () => {
    model.off("msg:custom", answer);
    model.off("change:points change:lines", follow);
    model.off("change:part change:size change:invitation", followPart);
    view.remove();
  };
}

export default { render };
