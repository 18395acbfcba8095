/* Pointer input and wet ink on an ipycanvas MultiCanvas.
 *
 * Model   canvas: "IPY_MODEL_<id>" of the MultiCanvas; tool: 0 pen, 1 eraser; mirror, about x = middle; colour; line_width and radius in canvas
 *         units (the canvas is the unit square, y down); invitation: words shown on the empty pad; live: whether the pen's
 *         stroke is sent while it is drawn; pieces: polylines [x, y, x, y, …] of which the eraser takes the nearest one whole,
 *         and outline: one, or none, of which it takes what it covers: that is marked while the eraser hovers over it.
 * Sends   {type: "ready"} when the lines must be drawn: a view is shown; {type: "cancelled"} when a stroke was, and what
 *         it rubbed out or gave the head so far must go;
 *         {type: "stroke", stroke: id, tool, mirror} with one buffer: Float32 (n, 4) x, y, pressure, milliseconds.
 *         {type: "partial", stroke: id, mirror} with such a buffer: the pen's stroke so far, as often as pacing.js says.
 * Takes   {type: "followed", stroke: id}: the kernel has answered a partial stroke;
 *         {type: "dry", stroke: id}: the kernel has answered that stroke, and drawn what has become of it.
 * Class   "sketchwidget-drawing" on the pad's element while the pen is down.
 * Events  on the pad's element, bubbling: "sketchwidget:ink" {detail: {since, drawn}}, the time stamps of the first pointer
 *         event in a drawn frame and of the end of its drawing; "sketchwidget:stroke" {detail: {stroke}} when one is sent.
 *
 * Uses two internals of ipycanvas 0.14: a layer model's `ctx` and its "new-frame" event. Ink is drawn on the last layer; the
 * eraser rubs out on the layer below it, which the kernel then redraws. All ink stays on the pad: a stroke that runs over the
 * edge follows the edge, and ends where it left for good.
 */

const CANVAS_EVENTS = [
  "mousedown", "mousemove", "mouseup", "mouseout", "wheel", "touchstart", "touchmove", "touchend", "touchcancel", "keydown",
];
// Browsers hold pointermove back until the next frame; the raw event comes at once, where there is one.
const MOVED = "onpointerrawupdate" in window ? "pointerrawupdate" : "pointermove";
const PEN_ERASER_BUTTON = 32; // PointerEvent.buttons of a stylus turned over

const clamp = (value) => Math.min(1, Math.max(0, value));
const outside = ([x, y]) => x < 0 || x > 1 || y < 0 || y > 1;

/** Where the way from a point on the pad to one beyond it crosses the edge; the rest of the sample is the latter's. */
function crossing([ax, ay], [bx, by, ...rest]) {
  const share = (a, b) => (b > 1 ? (1 - a) / (b - a) : b < 0 ? a / (a - b) : 1);
  const t = Math.min(share(ax, bx), share(ay, by));
  return [clamp(ax + t * (bx - ax)), clamp(ay + t * (by - ay)), ...rest];
}

/** The points of a stroke that count: those beyond the edge moved onto it, those after it left for good dropped. */
function onPad(points) {
  let end = points.length;
  while (end > 0 && outside(points[end - 1])) end -= 1;
  const kept = points.slice(0, end).map(([x, y, ...rest]) => [clamp(x), clamp(y), ...rest]);
  if (end > 0 && end < points.length) kept.push(crossing(kept[end - 1], points[end]));
  return kept;
}

/** Squared distance of a point from the edge that ends at number `i` of a polyline [x, y, x, y, …]. */
function toEdge(x, y, line, i) {
  const [ax, ay, bx, by] = line.slice(2 * i - 2, 2 * i + 2);
  const length = (bx - ax) ** 2 + (by - ay) ** 2;
  const t = length ? clamp(((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length) : 0;
  return (ax + t * (bx - ax) - x) ** 2 + (ay + t * (by - ay) - y) ** 2;
}

/** The polyline that is nearest to a point, none if all are further than a radius. */
function nearest(pieces, x, y, radius) {
  let found = null;
  let least = radius ** 2;
  for (const line of pieces) {
    for (let i = 1; 2 * i < line.length; i += 1) {
      const away = toEdge(x, y, line, i);
      if (away <= least) [found, least] = [line, away];
    }
  }
  return found;
}

function trace(ctx, points, size) {
  ctx.beginPath();
  ctx.moveTo(points[0][0] * size, points[0][1] * size);
  for (const [x, y] of points.length > 1 ? points.slice(1) : points) ctx.lineTo(x * size, y * size);
  ctx.stroke();
}

async function render({ model, el }) {
  const manager = model.widget_manager;
  const canvas = await manager.get_model(model.get("canvas").slice("IPY_MODEL_".length));
  const layers = canvas.get("_canvases");
  const wet = layers[layers.length - 1];
  const lines = layers[layers.length - 2];
  const view = await manager.create_view(canvas);

  const pad = document.createElement("div");
  const words = document.createElement("div");
  const ring = document.createElement("div");
  const taken = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  taken.setAttribute("class", "sketchwidget-taken");
  taken.setAttribute("viewBox", "0 0 1 1");
  taken.innerHTML = `<clipPath><circle /></clipPath><polyline />`;
  const [clip, line] = taken.children;
  pad.className = "sketchwidget-pad";
  pad.tabIndex = 0;
  pad.setAttribute("role", "img");
  pad.setAttribute("aria-label", "Drawing pad");
  words.className = "sketchwidget-invitation";
  ring.className = "sketchwidget-ring";
  pad.append(view.el, words, taken, ring);
  el.classList.add("sketchwidget-square");
  el.append(pad);

  const page = Math.random().toString(36).slice(2);
  clip.id = `sketchwidget-covered-${page}`;
  let count = 0;
  let stroke = null; // the one being drawn: {id, pointer, tool, mirror, points, drawn, sent, start}
  const waiting = new Map(); // id -> a stroke sent and not yet answered
  let frame = 0;
  let since = null;

  function style(ctx, tool) {
    ctx.lineCap = ctx.lineJoin = "round";
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
    ctx.strokeStyle = model.get("colour");
    ctx.globalCompositeOperation = tool === 1 ? "destination-out" : "source-over";
    ctx.lineWidth = (tool === 1 ? 2 * model.get("radius") : model.get("line_width")) * wet.canvas.width;
  }

  /** Draws a stroke from its point number `from` on; the number of its points drawn so far. */
  function draw(one, from) {
    const layer = one.tool === 1 ? lines : wet;
    const kept = onPad(one.points);
    const points = kept.slice(Math.max(0, from - 1));
    if (!points.length) return from;
    layer.ctx.save();
    style(layer.ctx, one.tool);
    trace(layer.ctx, points, wet.canvas.width);
    if (one.mirror) {
      const middle = model.get("middle");
      trace(layer.ctx, points.map(([x, y]) => [2 * middle - x, y]), wet.canvas.width);
    }
    layer.ctx.restore();
    return kept.length;
  }

  function repaint() {
    const { width, height } = wet.canvas;
    // In halves: some browsers forget it when a canvas is cleared whole and nothing is drawn after that.
    const half = Math.floor(height / 2);
    wet.ctx.clearRect(0, 0, width, half);
    wet.ctx.clearRect(0, half, width, height - half);
    for (const one of waiting.values()) if (one.tool === 0) draw(one, 0);
    if (stroke) stroke.drawn = draw(stroke, 0);
    wet.trigger("new-frame");
  }

  function paint() {
    if (!stroke || since === null) return;
    stroke.drawn = draw(stroke, stroke.drawn);
    wet.trigger("new-frame");
    const first = since;
    since = null;
    // ipycanvas brings a new frame to its views in a microtask, which is before this one.
    queueMicrotask(() => {
      const detail = { since: first, drawn: performance.now() };
      pad.dispatchEvent(new CustomEvent("sketchwidget:ink", { bubbles: true, detail }));
    });
  }

  function add(event) {
    const box = pad.getBoundingClientRect();
    const samples = event.getCoalescedEvents?.() ?? [];
    for (const one of samples.length ? samples : [event]) {
      const x = (one.clientX - box.left - pad.clientLeft) / pad.clientWidth;
      const y = (one.clientY - box.top - pad.clientTop) / pad.clientHeight;
      stroke.points.push([x, y, one.pressure, one.timeStamp - stroke.start]);
    }
    since ??= event.timeStamp;
    if (frame) return;
    // At once, and what else comes before the next frame together with it.
    paint();
    frame = requestAnimationFrame(() => {
      frame = 0;
      paint();
    });
  }

  const pace = paced(() => {
    if (!model.get("live") || stroke?.tool !== 0 || stroke.points.length === stroke.sent) return null;
    const points = onPad(stroke.points);
    if (points.length < 2) return null;
    stroke.sent = stroke.points.length;
    model.send({ type: "partial", stroke: stroke.id, mirror: stroke.mirror }, undefined, [Float32Array.from(points.flat()).buffer]);
    return stroke.id;
  });

  function moveRing(event) {
    const box = pad.getBoundingClientRect();
    const x = event.clientX - box.left - pad.clientLeft;
    const y = event.clientY - box.top - pad.clientTop;
    ring.style.transform = `translate(${x}px, ${y}px) translate(-50%, -50%)`;
    mark(x / pad.clientWidth, y / pad.clientHeight);
  }

  /** Marks what the eraser would take at a point. */
  function mark(x, y) {
    const [pieces, outline, radius] = [model.get("pieces"), model.get("outline"), model.get("radius")];
    const erases = model.get("tool") === 1 && !stroke;
    const found = erases ? nearest([...pieces, outline], x, y, radius) : null;
    for (const [name, value] of Object.entries({ cx: x, cy: y, r: radius })) clip.firstChild.setAttribute(name, value);
    line.setAttribute("clip-path", found === outline ? `url(#${clip.id})` : "none");
    line.setAttribute("points", found ? found.join(" ") : "");
  }

  function down(event) {
    if (stroke || !event.isPrimary || (event.button !== 0 && !(event.buttons & PEN_ERASER_BUTTON))) return;
    event.preventDefault();
    pad.focus({ preventScroll: true });
    pad.setPointerCapture(event.pointerId);
    words.hidden = true;
    pad.classList.add("sketchwidget-drawing");
    stroke = {
      id: `${page}-${count++}`,
      pointer: event.pointerId,
      tool: event.buttons & PEN_ERASER_BUTTON ? 1 : model.get("tool"),
      mirror: model.get("mirror"),
      points: [],
      drawn: 0,
      sent: 0,
      start: event.timeStamp,
    };
    add(event);
  }

  function move(event) {
    if (event.pointerId !== stroke?.pointer) return;
    if (event.buttons === 0) up(event); // the release happened where no page could see it
    else {
      add(event);
      pace.ask();
    }
  }

  function up(event) {
    if (event.pointerId !== stroke?.pointer) return;
    if (event.type === "pointerup") add(event);
    paint();
    const { id, tool, mirror, points } = stroke;
    stroke = null;
    pad.classList.remove("sketchwidget-drawing");
    const kept = onPad(points);
    waiting.set(id, { tool, mirror, points: kept });
    repaint();
    pad.dispatchEvent(new CustomEvent("sketchwidget:stroke", { bubbles: true, detail: { stroke: id } }));
    model.send({ type: "stroke", stroke: id, tool, mirror }, undefined, [Float32Array.from(kept.flat()).buffer]);
  }

  function cancel(event) {
    if (event.pointerId !== stroke?.pointer) return;
    stroke = null;
    pad.classList.remove("sketchwidget-drawing");
    repaint();
    showWords();
    model.send({ type: "cancelled" });
  }

  function answer(message) {
    if (message.type === "followed") pace.answered(message.stroke);
    else dry(message);
  }

  function dry(message) {
    if (message.type !== "dry" || !waiting.has(message.stroke)) return;
    // The lines arrive by another widget's message: wait until they are on screen, so that the ink never blinks.
    shown(() => {
      waiting.delete(message.stroke);
      repaint();
    });
  }

  function fit() {
    const size = Math.round(pad.clientWidth * (window.devicePixelRatio || 1));
    // Only ever larger: two pages that show one pad at different sizes do not pull it to and fro.
    if (size > canvas.get("width")) {
      for (const one of [canvas, ...layers]) one.set({ width: size, height: size });
      canvas.save_changes();
    }
  }

  function showWords() {
    words.textContent = model.get("invitation");
    words.hidden = !model.get("invitation");
  }

  function showTool() {
    mark(-1, -1);
    pad.classList.toggle("sketchwidget-erasing", model.get("tool") === 1);
    pad.classList.toggle("sketchwidget-mirrored", model.get("mirror"));
    pad.style.setProperty("--sw-middle", `${100 * model.get("middle")}%`);
    ring.style.width = ring.style.height = `${200 * model.get("radius")}%`;
  }

  for (const type of CANVAS_EVENTS) pad.addEventListener(type, (event) => event.target !== pad && event.stopPropagation(), { capture: true });
  pad.addEventListener("pointerdown", down);
  pad.addEventListener("pointermove", moveRing);
  pad.addEventListener(MOVED, move);
  pad.addEventListener("pointerup", up);
  pad.addEventListener("lostpointercapture", up);
  pad.addEventListener("pointercancel", cancel);
  model.on("msg:custom", answer);
  model.on("change:invitation", showWords);
  model.on("change:tool change:mirror change:middle change:radius change:pieces change:outline", showTool);
  window.addEventListener("resize", fit);
  const sizes = new ResizeObserver(fit);
  sizes.observe(pad);
  showWords();
  showTool();
  model.send({ type: "ready" });

  return () => {
    pace.stop();
    sizes.disconnect();
    window.removeEventListener("resize", fit);
    model.off("msg:custom", answer);
    model.off("change:invitation", showWords);
    model.off("change:tool change:mirror change:middle change:radius change:pieces change:outline", showTool);
    view.remove();
  };
}

export default { render };
