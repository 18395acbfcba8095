/* When a stroke that is being drawn is sent: at most 15 times a second, never before the last part was answered and what came of
 * it is on screen, and the longer that took, the fewer: a busy kernel never has a queue of them, and a slow page no more than it
 * can draw. Where the pen rests, what was not sent yet follows.
 *
 * A widget's module can import no file beside it: this stands before the modules that use it (pacing.py).
 */

const PARTIAL_EVERY = 1000 / 15; // milliseconds
const REST = 3; // times what an answer takes until it is on screen: so long, at least, from one to the next, or the end of a stroke would wait
const LONGEST_REST = 1000; // milliseconds: a kernel that was busy once is asked again

/** Calls back once what came with a message is on screen. */
function shown(then) {
  requestAnimationFrame(() => requestAnimationFrame(then));
}

/** Paces `send`, which sends what is new of a stroke and gives its id, or null if there is nothing to send. */
function paced(send) {
  let asked = null; // the stroke of which a part waits for its answer
  let lastAsked = 0;
  let took = 0; // milliseconds that the last answer took
  let later = 0; // the timer of what could not be sent yet
  let stopped = false;

  /** Sends the stroke so far as soon as there is time for it. */
  function ask() {
    clearTimeout(later);
    if (stopped || asked !== null) return;
    const rest = Math.max(PARTIAL_EVERY, Math.min(REST * took, LONGEST_REST));
    const wait = lastAsked + rest - performance.now();
    if (wait > 0) {
      later = setTimeout(ask, wait);
      return;
    }
    asked = send();
    if (asked !== null) lastAsked = performance.now();
  }

  /** A part of a stroke was answered. */
  function answered(stroke) {
    if (stroke !== asked) return;
    shown(() => {
      asked = null;
      took = performance.now() - lastAsked;
      ask();
    });
  }

  function stop() {
    stopped = true;
    clearTimeout(later);
  }

  return { ask, answered, stop };
}

