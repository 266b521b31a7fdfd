// Messages take effect at once, and not with the next frame: whenever the recording starts anew or is scrubbed back, the
// page first turns on viser's own lights, and would show them until then. A page without these insides stays as it is.
const waiting = setInterval(() => {
  const viewer = window.__viserMutable;
  if (!viewer?.drainMessageQueue) return;
  clearInterval(waiting);
  const request = viewer.requestRender;
  let busy = false;
  viewer.requestRender = () => {
    request();
    if (busy) return;
    busy = true;
    try { viewer.drainMessageQueue?.(); } finally { busy = false; }
  };
}, 50);
