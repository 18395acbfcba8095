/* A pad over the head of the same Studio: brushes, gestures, and what they marked.
 *
 * Model   tool: 0 gesture, 1 brush, 2 unbrush, 3 orbit, from 4 on those that users added; active: whether the pad takes the pointer; radius of the brushes in
 *         canvas units (the view of the head is the unit square, y down).
 * Sends   {type: "ready"} when the marks must be sent;
 *         {type: "stroke" | "partial", stroke: id, tool, view: {rotation, scale, centre}} with one buffer: Float32 (n, 4) x, y,
 *         pressure, milliseconds. `view` is how the head was seen when the stroke began. A partial one is a gesture so far, sent
 *         as often as pacing.js says.
 * Takes   {type: "answer", stroke: id, text, good, partial}: a stroke was answered; its ink goes, unless it is a partial one, and the text, if any,
 *         flashes beside it;
 *         {type: "marks"} with two buffers: Int32 handles (h), and Int32 edges (e, 2) of the region's border.
 * Class   "sketchwidget-drawing" on the head's element while the pen is down, "sketchwidget-refining" while the pad is active.
 *
 * The right button and a drag with Alt turn the head whatever the tool: the controls of the view get them as a plain drag.
 */

const [GESTURE, BRUSH, UNBRUSH, ORBIT] = [0, 1, 2, 3];
const FLASH = 1800; // milliseconds
const FEWEST = 8; // points of a gesture so far: fewer are none yet
const CELLS = 200; // a side, in which what hides the marks is looked up
const BEHIND = 3; // millimetres behind the surface: what is deeper is hidden
const DOT = 0.005; // a side of a handle, in canvas units
const REGION = "#c2410c";
const INK = "#444444";

/** The View of a three.js camera whose frame is the unit square: see geometry/view.py. */
function viewOf(camera) {
  camera.updateMatrixWorld();
  const m = camera.matrixWorld.elements;
  const rotation = [0, 4, 8].map((at) => [m[at], m[at + 1], m[at + 2]]);
  const place = [m[12], m[13], m[14]];
  const along = (axis) => axis.reduce((sum, value, at) => sum + value * place[at], 0);
  const { left, right, top, bottom, zoom } = camera;
  const scale = zoom / (right - left);
  const centre = [0.5 - (along(rotation[0]) + (left + right) / 2) * scale, 0.5 + (along(rotation[1]) + (top + bottom) / 2) * scale];
  return { rotation, scale, centre };
}

function render({ model, el }) {
  el.style.display = "none";
  const page = Math.random().toString(36).slice(2);
  const ink = document.createElement("canvas");
  const flash = document.createElement("div");
  ink.className = "sketchwidget-marks";
  flash.className = "sketchwidget-flash";
  let host = null;
  let count = 0;
  let stroke = null; // the one being drawn: {id, pointer, tool, view, points, sent, start}
  let last = null; // the one that was sent, until it is answered
  let handles = new Int32Array();
  let border = new Int32Array();
  let drawn = "";
  let seen = ""; // the head and the camera of `nearest`
  let nearest = null;
  let frame = 0;
  let fading = 0;

  function point(event) {
    const box = host.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  }

  /** Projects vertices, and tells which of them are seen: they face the viewer, and nothing lies before them. */
  function projector(view) {
    const { geometry } = host.sketchwidget;
    const position = geometry.getAttribute("position").array;
    const normal = geometry.getAttribute("normal")?.array;
    const [x, y, z] = view.rotation;
    const dot = (axis, array, at) => axis[0] * array[at] + axis[1] * array[at + 1] + axis[2] * array[at + 2];
    const place = (vertex) => {
      const at = 3 * vertex;
      return [view.centre[0] + view.scale * dot(x, position, at), view.centre[1] - view.scale * dot(y, position, at), dot(z, position, at)];
    };
    nearest ??= surface(geometry.index.array, place);
    return (vertex) => {
      const [px, py, depth] = place(vertex);
      const facing = !normal || dot(z, normal, 3 * vertex) > 0;
      const [column, row] = [Math.floor(px * CELLS), Math.floor(py * CELLS)];
      const inside = column >= 0 && column < CELLS && row >= 0 && row < CELLS;
      return [px, py, facing && inside && depth > nearest[row * CELLS + column] - BEHIND];
    };
  }

  /** The depth of what is nearest to the viewer at the middle of each cell of the pad, row after row. */
  function surface(corners, place) {
    const nearest = new Float32Array(CELLS * CELLS).fill(-Infinity);
    for (let at = 0; at < corners.length; at += 3) {
      const [[ax, ay, a], [bx, by, b], [cx, cy, c]] = [place(corners[at]), place(corners[at + 1]), place(corners[at + 2])];
      const area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
      if (area >= 0) continue; // it faces away, as y goes down
      const first = (low) => Math.max(0, Math.ceil(low * CELLS - 0.5));
      const last = (high) => Math.min(CELLS - 1, Math.floor(high * CELLS - 0.5));
      for (let row = first(Math.min(ay, by, cy)); row <= last(Math.max(ay, by, cy)); row++) {
        for (let column = first(Math.min(ax, bx, cx)); column <= last(Math.max(ax, bx, cx)); column++) {
          const [px, py] = [(column + 0.5) / CELLS - ax, (row + 0.5) / CELLS - ay];
          const s = (px * (cy - ay) - (cx - ax) * py) / area;
          const t = ((bx - ax) * py - px * (by - ay)) / area;
          const cell = row * CELLS + column;
          if (s >= 0 && t >= 0 && s + t <= 1) nearest[cell] = Math.max(nearest[cell], a + s * (b - a) + t * (c - a));
        }
      }
    }
    return nearest;
  }

  function paint() {
    const size = Math.round(host.clientWidth * (window.devicePixelRatio || 1));
    if (ink.width !== size) ink.width = ink.height = size;
    const ctx = ink.getContext("2d");
    // In halves: some browsers forget it when a canvas is cleared whole and nothing is drawn after that.
    const half = Math.floor(size / 2);
    ctx.clearRect(0, 0, size, half);
    ctx.clearRect(0, half, size, size - half);
    const project = handles.length || border.length ? projector(viewOf(host.sketchwidget.camera)) : null;
    ctx.lineCap = ctx.lineJoin = "round";
    ctx.lineWidth = 0.004 * size;
    ctx.strokeStyle = REGION;
    ctx.beginPath();
    for (let edge = 0; edge + 1 < border.length; edge += 2) {
      const [ax, ay, a] = project(border[edge]);
      const [bx, by, b] = project(border[edge + 1]);
      if (!a || !b) continue;
      ctx.moveTo(ax * size, ay * size);
      ctx.lineTo(bx * size, by * size);
    }
    ctx.stroke();
    const colour = getComputedStyle(host).getPropertyValue("--sw-mark");
    ctx.fillStyle = colour;
    for (const vertex of handles) {
      const [x, y, seen] = project(vertex);
      if (seen) ctx.fillRect((x - DOT / 2) * size, (y - DOT / 2) * size, DOT * size, DOT * size);
    }
    for (const one of [last, stroke]) if (one) trace(ctx, one, size, colour);
  }

  function trace(ctx, { tool, points }, size, colour) {
    const brushes = tool === BRUSH || tool === UNBRUSH;
    ctx.globalAlpha = brushes ? 0.3 : 1;
    ctx.strokeStyle = tool === BRUSH ? colour : tool === UNBRUSH ? "#888888" : INK;
    ctx.lineWidth = (brushes ? 2 * model.get("radius") : 0.006) * size;
    ctx.beginPath();
    points.forEach(([x, y], at) => (at ? ctx.lineTo(x * size, y * size) : ctx.moveTo(x * size, y * size)));
    if (points.length === 1) ctx.lineTo(points[0][0] * size, points[0][1] * size);
    ctx.stroke();
    ctx.globalAlpha = 1;
  }

  /** While the pad is active: paints again whatever has changed, the camera included. */
  function watch() {
    frame = model.get("active") && host?.isConnected ? requestAnimationFrame(watch) : 0;
    if (!host?.sketchwidget) return;
    const { camera, serial } = host.sketchwidget;
    const sight = [serial, camera.zoom, camera.left, camera.top, ...camera.matrixWorld.elements].join();
    if (sight !== seen) [seen, nearest] = [sight, null];
    const state = [sight, host.clientWidth, handles.length, border.length, stroke?.points.length, last?.id].join();
    if (state === drawn) return;
    drawn = state;
    paint();
  }

  const message = (type, { id, tool, view, points }) =>
    model.send({ type, stroke: id, tool, view }, undefined, [Float32Array.from(points.flat()).buffer]);

  const pace = paced(() => {
    if (stroke?.tool !== GESTURE || stroke.points.length < FEWEST || stroke.points.length === stroke.sent) return null;
    stroke.sent = stroke.points.length;
    message("partial", stroke);
    return stroke.id;
  });

  function add(event) {
    const samples = event.getCoalescedEvents?.() ?? [];
    for (const one of samples.length ? samples : [event]) stroke.points.push([...point(one), one.pressure, one.timeStamp - stroke.start]);
  }

  const turns = (event) => !model.get("active") || model.get("tool") === ORBIT || event.button === 2 || event.altKey;

  function down(event) {
    if (turns(event) || stroke || !event.isPrimary || event.button !== 0 || !host.sketchwidget) return;
    event.preventDefault(); // no mouse event follows, and the controls of the view see none
    event.stopImmediatePropagation();
    host.setPointerCapture(event.pointerId);
    host.focus({ preventScroll: true });
    host.classList.add("sketchwidget-drawing");
    stroke = { id: `${page}-${count++}`, pointer: event.pointerId, tool: model.get("tool"), points: [], sent: 0, start: event.timeStamp,
      view: viewOf(host.sketchwidget.camera) };
    add(event);
  }

  function move(event) {
    if (event.pointerId !== stroke?.pointer) return;
    event.stopImmediatePropagation();
    if (event.buttons === 0) up(event); // the release happened where no page could see it
    else {
      add(event);
      pace.ask();
    }
  }

  function up(event) {
    if (event.pointerId !== stroke?.pointer) return;
    event.stopImmediatePropagation();
    host.classList.remove("sketchwidget-drawing");
    last = stroke;
    stroke = null;
    message("stroke", last);
  }

  function cancel(event) {
    if (event.pointerId !== stroke?.pointer) return;
    host.classList.remove("sketchwidget-drawing");
    stroke = null;
    model.send({ type: "cancelled" });
  }

  /** Touches are the pen's as well: the controls would turn the head under it. */
  function touch(event) {
    if (!model.get("active") || model.get("tool") === ORBIT) return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }

  /** The right button and Alt as a plain drag, which is how the controls turn the head. */
  function press(event) {
    if (!model.get("active") || !event.isTrusted || (event.button !== 2 && !event.altKey)) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    const { clientX, clientY, view } = event;
    event.target.dispatchEvent(new MouseEvent("mousedown", { bubbles: true, cancelable: true, clientX, clientY, view, button: 0 }));
  }

  function answer(said, buffers) {
    if (said.type === "marks") {
      [handles, border] = buffers.map((one) => new Int32Array(one.buffer.slice(one.byteOffset, one.byteOffset + one.byteLength)));
      drawn = "";
    } else if (said.type === "answer") {
      if (said.partial) pace.answered(said.stroke);
      if (said.partial || said.stroke !== last?.id) return;
      const [x, y] = last.points[last.points.length - 1];
      last = null;
      show(said, x, y);
    }
  }

  function show({ text, good }, x, y) {
    if (!text) return;
    flash.textContent = text;
    flash.classList.toggle("sketchwidget-error", !good);
    flash.style.left = `${100 * Math.min(0.7, Math.max(0.02, x))}%`;
    flash.style.top = `${100 * Math.min(0.9, Math.max(0.02, y + 0.02))}%`;
    flash.hidden = false;
    clearTimeout(fading);
    fading = setTimeout(() => (flash.hidden = true), FLASH);
  }

  function activate() {
    if (!host) return;
    const active = model.get("active");
    host.classList.toggle("sketchwidget-refining", active && model.get("tool") !== ORBIT);
    ink.hidden = !active;
    if (!active) flash.hidden = true;
    drawn = "";
    if (active && !frame) watch();
  }

  const LISTENERS = {
    pointerdown: down, pointermove: move, pointerup: up, lostpointercapture: up, pointercancel: cancel,
    touchstart: touch, touchmove: touch, mousedown: press,
  };

  /** The head's view comes in its own time. */
  function attach() {
    host = el.closest(".sketchwidget-studio")?.querySelector(".sketchwidget-head") ?? null;
    if (!host) {
      waiting = requestAnimationFrame(attach);
      return;
    }
    host.append(ink, flash);
    flash.hidden = true;
    for (const [type, listener] of Object.entries(LISTENERS)) host.addEventListener(type, listener, { capture: true, passive: false });
    activate();
    model.send({ type: "ready" });
  }

  let waiting = requestAnimationFrame(attach);
  model.on("msg:custom", answer);
  model.on("change:active change:tool", activate);

  return () => {
    pace.stop();
    cancelAnimationFrame(waiting);
    cancelAnimationFrame(frame);
    for (const [type, listener] of Object.entries(LISTENERS)) host?.removeEventListener(type, listener, { capture: true });
    model.off("msg:custom", answer);
    model.off("change:active change:tool", activate);
    ink.remove();
    flash.remove();
  };
}

export default { render };
