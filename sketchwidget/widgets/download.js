/* Bytes from the kernel as downloads of the browser.
 *
 * Takes   {type: "file", name, mime} with one buffer, the file's content compressed by gzip: a Jupyter server drops what
 *         a kernel sends beyond about 3 MB in 3 seconds, and a head as OBJ is 2 MB.
 *
 * One file a page, however many views the page has.
 */

function initialize({ model }) {
  model.on("msg:custom", async (message, buffers) => {
    if (message.type !== "file") return;
    const content = new Blob([buffers[0]]).stream().pipeThrough(new DecompressionStream("gzip"));
    const file = new Blob([await new Response(content).arrayBuffer()], { type: message.mime });
    const link = document.createElement("a");
    link.href = URL.createObjectURL(file);
    link.download = message.name;
    document.body.append(link);
    link.click();
    link.remove();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000); // the browser may still be asking where to
  });
}

function render({ el }) {
  el.style.display = "none";
}

export default { initialize, render };
