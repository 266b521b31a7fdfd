// What the page itself does: keys that leave the camera alone, hints where viser shows none, telling the server whether
// the page is in view and whether the browser is set to dark pages, its title, and what happens when the server is lost.
// All of it is only for comfort: without it everything works and can be read. `this` is the picture that runs this
// script; the rules of page.css find the page and its panel by the names that they get here.
this.parentElement.dataset.trackride = 'page';
this.parentElement.parentElement.dataset.trackride = 'panel';
// After a lost connection viser builds all anew in a page whose panels have their sizes already. The page is loaded
// afresh instead: it comes back as it was, from what the browser has stored.
{
  const {inView} = document.getElementById('trackride-style').dataset;  // another one in each session
  if ((document.body.dataset.session ??= inView) !== inView) location.reload();
}
if (!document.body.dataset.trackride) {
  document.body.dataset.trackride = 'keys';
  // viser turns and moves the camera with some of our keys, wherever they are pressed, on a slider too
  document.body.addEventListener('keydown', (event) => {
    if (event.target.role === 'slider' && event.key.startsWith('Arrow')) event.stopPropagation();
  });
  document.documentElement.addEventListener('keydown', (event) => {
    if (['ArrowLeft', 'ArrowRight', 'KeyD', 'KeyS'].includes(event.code)) event.stopPropagation();
  });
  // viser shows hints over boxes only: here also over their labels, and over plain buttons, whose hints `add_hints` sends
  for (const [moved, into] of [['mouseover', 'mouseenter'], ['mouseout', 'mouseleave']]) {
    document.body.addEventListener(moved, ({target, clientX, clientY}) => {
      const button = target.closest?.('button[id]');
      if (button && !button.title)
        button.title = JSON.parse(document.getElementById('trackride-hints')?.dataset.hints ?? '{}')[button.id] ?? '';
      const name = target.closest?.('label[for]')?.closest('div[style]');
      const hinted = name?.nextElementSibling?.firstElementChild;
      hinted?.dispatchEvent(new PointerEvent('pointerover', {bubbles: true, pointerType: 'mouse'}));
      hinted?.dispatchEvent(new MouseEvent(into, {clientX, clientY}));
    });
  }
  // Hidden checkboxes, whose ids stand in the data of the style, carry what the page tells: a page in the background
  // takes the tick from one, and a browser that is set to dark pages gives the other its tick
  const tick = (name, on) => {
    const box = document.getElementById(document.getElementById('trackride-style')?.dataset[name]);
    if (box && box.checked !== on) box.click();
  };
  document.addEventListener('visibilitychange', () => tick('inView', !document.hidden));
  const night = matchMedia('(prefers-color-scheme: dark)');
  const wish = () => tick('night', night.matches);
  night.addEventListener('change', wish);
  setTimeout(wish);
  customElements.define('trackride-title', class extends HTMLElement {
    connectedCallback() { document.title = this.getAttribute('of'); }
  });
  // While the server cannot be reached, viser dims all panels and takes no clicks; keys are left to us
  const lost = () => document.querySelector('div[style*="opacity 150ms"][style*="pointer-events: none"]') !== null;
  const word = Object.assign(document.createElement('div'), {className: 'trackride-lost', role: 'status', hidden: true});
  word.textContent = 'Not connected: waiting for Trackride. Nothing can be changed until it answers.';
  document.body.append(word);
  setInterval(() => word.hidden = !lost(), 300);
  document.documentElement.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || /^F\d/.test(event.key) || !lost()) return;
    event.stopImmediatePropagation();
    event.preventDefault();
  }, true);
}
