/* Positions streamed into a pythreejs BufferGeometry, a whole frame at a time, and the camera that looks at it.
 *
 * Model   renderer, geometry, material, swatch: "IPY_MODEL_<id>" of the pythreejs Renderer (orthographic camera, orbit
 *         controls), of the mesh's geometry and material, and of any DataTexture, the class of which textures are made.
 * Sends   {type: "ready"} when the page can take positions.
 * Takes   {type: "mesh", serial, passing, scale, centre: [x, y]} with one buffer: Float32 (V, 3), millimetres. `scale` (canvas units a
 *         millimetre) and `centre` place the head's origin on the unit square that the view shows, y down; a passing one
 *         counts only while a pad on the page has the class "sketchwidget-drawing";
 *         {type: "look", direction: [x, y, z]}: turn until the camera looks from there, zoom and shift undone.
 *         {type: "skin"} with two buffers: Float32 (V, 2), places in a texture, v upwards, and an image file: shown on the mesh
 *         in place of the colours of its vertices; without buffers, these again.
 * Events  on the geometry "sketchwidget:placed" after a mesh has come; and "sketchwidget:posed", from another widget that has
 *         written its positions: they are shown;
 *         on the view's element, bubbling: "sketchwidget:frame" {detail: {serial, drawn}} after a mesh is rendered. That
 *         element has a property `sketchwidget` = {geometry, camera, serial}, the three.js objects on show.
 *
 * Positions are written in place, normals computed, the camera's frame set and everything rendered in one animation frame, so
 * that no half of an update is ever seen. Where several updates wait for a frame, the last one counts.
 */

const DISTANCE = 1000; // of the camera in millimetres; an orthographic picture does not depend on it
const TURN = 260; // milliseconds that a change of view takes

const [NO_COLOURS, VERTEX_COLOURS, LINEAR, LINEAR_MIPMAPS] = [0, 2, 1006, 1008]; // three.js's own numbers

const resolve = (model, name) => model.widget_manager.get_model(model.get(name).slice("IPY_MODEL_".length));

/** Spherical angles of a direction: about the upward axis, and from it. */
function angles({ x, y, z }) {
  return [Math.atan2(x, z), Math.acos(Math.min(1, Math.max(-1, y / Math.hypot(x, y, z))))];
}

export default () => {
  const views = new Set();
  let geometry, camera, controls, material, DataTexture; // three.js
  let skins = 0;
  let pending = null;
  let serial = 0;
  let frame = 0;

  const floats = (buffer) => new Float32Array(buffer.buffer.slice(buffer.byteOffset, buffer.byteOffset + buffer.byteLength));

  function setPositions(buffer) {
    geometry.getAttribute("position").array.set(floats(buffer));
    follow();
  }

  function follow() {
    geometry.getAttribute("position").needsUpdate = true;
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
  }

  function posed() {
    follow();
    renderAll();
  }

  async function setSkin(places, file) {
    const number = ++skins;
    const texture = file && (await decoded(file));
    if (number !== skins) return; // another came while this one was decoded
    if (texture) {
      const { constructor: Attribute } = geometry.getAttribute("position");
      geometry.addAttribute("uv", new Attribute(floats(places), 2));
    }
    material.map?.dispose();
    material.map = texture ?? null;
    material.vertexColors = texture ? NO_COLOURS : VERTEX_COLOURS;
    material.needsUpdate = true;
    renderAll();
    for (const { host } of views) host.classList.toggle("sketchwidget-textured", Boolean(texture));
  }

  /** An image file as a texture: the first row of pixels is at v = 1. */
  async function decoded(file) {
    const image = await createImageBitmap(new Blob([file]));
    const { width, height } = image;
    const canvas = Object.assign(document.createElement("canvas"), { width, height });
    const context = canvas.getContext("2d");
    context.translate(0, height);
    context.scale(1, -1);
    context.drawImage(image, 0, 0);
    const texture = new DataTexture(new Uint8Array(context.getImageData(0, 0, width, height).data.buffer), width, height);
    Object.assign(texture, { magFilter: LINEAR, minFilter: LINEAR_MIPMAPS, generateMipmaps: true, needsUpdate: true });
    return texture;
  }

  function setFrame(scale, [x, y]) {
    Object.assign(camera, { left: -x / scale, right: (1 - x) / scale, top: y / scale, bottom: (y - 1) / scale });
    camera.updateProjectionMatrix();
  }

  function renderAll() {
    for (const { view } of views) view.renderScene();
  }

  const isLate = (message) => message.passing && !document.querySelector(".sketchwidget-drawing");

  function apply() {
    frame = 0;
    const { message, buffer } = pending;
    pending = null;
    if (isLate(message)) return;
    setPositions(buffer);
    setFrame(message.scale, message.centre);
    renderAll();
    geometry.dispatchEvent({ type: "sketchwidget:placed" });
    serial = message.serial;
    for (const { host } of views) announce(host);
  }

  function announce(host) {
    host.classList.add("sketchwidget-shown");
    host.sketchwidget = { geometry, camera, serial };
    host.dispatchEvent(new CustomEvent("sketchwidget:frame", { bubbles: true, detail: { serial, drawn: performance.now() } }));
  }

  function look([x, y, z]) {
    const target = controls.target.clone();
    const from = angles(camera.position.clone().sub(target));
    const to = angles({ x, y, z });
    const about = ((to[0] - from[0] + 3 * Math.PI) % (2 * Math.PI)) - Math.PI; // the short way round
    const zoom = camera.zoom;
    const start = performance.now();
    const turn = matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : TURN;

    function step(now) {
      const t = turn ? Math.min(1, Math.max(0, (now - start) / turn)) : 1;
      const eased = t * t * (3 - 2 * t);
      const [azimuth, polar] = [from[0] + eased * about, from[1] + eased * (to[1] - from[1])];
      controls.target.copy(target).multiplyScalar(1 - eased);
      camera.position
        .set(Math.sin(polar) * Math.sin(azimuth), Math.cos(polar), Math.sin(polar) * Math.cos(azimuth))
        .multiplyScalar(DISTANCE)
        .add(controls.target);
      camera.zoom = zoom + eased * (1 - zoom);
      camera.updateProjectionMatrix();
      controls.update();
      renderAll();
      if (t < 1) requestAnimationFrame(step);
    }
    requestAnimationFrame(step);
  }

  async function connect(model) {
    const renderer = await resolve(model, "renderer");
    const geometryModel = await resolve(model, "geometry");
    const materialModel = await resolve(model, "material");
    const swatch = await resolve(model, "swatch");
    await Promise.all([renderer, geometryModel, materialModel, swatch].map((made) => made.initPromise));
    const controlsModel = renderer.get("controls")[0];
    // Each drag would send the camera to the kernel, and the answer turn it back under the next drag.
    controlsModel.update_controlled = () => {};
    geometry = geometryModel.obj;
    geometry.addEventListener("sketchwidget:posed", posed);
    material = materialModel.obj;
    DataTexture = swatch.obj.constructor;
    camera = renderer.get("camera").obj;
    controls = controlsModel.obj;
    return renderer;
  }

  let connected = null;

  function initialize({ model }) {
    connected = connect(model);
    model.on("msg:custom", (message, buffers) => {
      if (message.type === "mesh" && !isLate(message)) {
        pending = { message, buffer: buffers[0] };
        connected.then(() => (frame ||= requestAnimationFrame(apply)));
      } else if (message.type === "skin") {
        connected.then(() => setSkin(...buffers));
      } else if (message.type === "look") {
        connected.then(() => look(message.direction));
      }
    });
    connected.then(() => model.send({ type: "ready" }));
  }

  async function render({ model, el }) {
    const renderer = await connected;
    const view = await model.widget_manager.create_view(renderer);
    const host = document.createElement("div");
    host.className = "sketchwidget-head";
    host.tabIndex = 0;
    host.setAttribute("role", "img");
    host.setAttribute("aria-label", "3D head");
    host.append(view.el);
    el.classList.add("sketchwidget-square");
    el.append(host);

    // pythreejs sizes its views from traits that all pages share; this one is as large as its place, at the page's own ratio.
    view.updateSize = () => {
      const size = host.clientWidth;
      if (!size || view.isFrozen) return;
      view.renderer.setPixelRatio(window.devicePixelRatio || 1);
      view.renderer.setSize(size, size);
    };
    function fit() {
      view.updateSize();
      view.renderScene();
    }
    // Captured, a drag goes on outside the view; three.js's controls would end it at the edge.
    const capture = (event) => event.target.setPointerCapture?.(event.pointerId);
    // The wheel scrolls the page until the head is clicked.
    const zoomable = () => (controls.enableZoom = document.activeElement === host);
    const focus = () => host.focus({ preventScroll: true });

    // A drag with the right button turns or shifts the head; the front end's own menu would open under it.
    const withoutMenu = (event) => {
      event.preventDefault();
      event.stopPropagation();
    };

    host.addEventListener("contextmenu", withoutMenu);
    host.addEventListener("pointerdown", capture);
    host.addEventListener("pointerup", focus);
    host.addEventListener("focus", zoomable);
    host.addEventListener("blur", zoomable);
    zoomable();
    const shown = { view, host };
    views.add(shown);
    const sizes = new ResizeObserver(fit);
    sizes.observe(host);
    window.addEventListener("resize", fit);
    if (serial) {
      fit();
      announce(host);
    }

    return () => {
      views.delete(shown);
      sizes.disconnect();
      window.removeEventListener("resize", fit);
      view.remove();
    };
  }

  return { initialize, render };
};
