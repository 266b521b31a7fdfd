// What the page itself does: keys that leave the camera alone, hints where viser shows none, when a typed value counts,
// telling the server whether the page is in view and whether the browser is set to dark pages, its title, and what
// happens when the server is lost.
// Without it everything works and can be read, but typed values count key by key. `this` is the picture that runs this
// script; the rules of page.css find the page and its panel by the names that they get here.
if (!this.isConnected) return;  // viser has drawn the page anew meanwhile, with another picture
this.parentElement.dataset.trackride = 'page';
this.parentElement.parentElement.dataset.trackride = 'panel';
// After a lost connection viser builds all anew in a page whose panels have their sizes already. The page is loaded
// afresh instead: it comes back as it was, from what it has stored.
{
  const {inView} = document.getElementById('trackride-style').dataset;  // another one in each session
  if ((document.body.dataset.session ??= inView) !== inView) location.reload();
}
// Hidden boxes of text, whose ids stand in the data of the style, carry what the page tells
const set = (box, text) => {
  const kind = box instanceof HTMLTextAreaElement ? HTMLTextAreaElement : HTMLInputElement;
  Object.getOwnPropertyDescriptor(kind.prototype, 'value').set.call(box, text);  // past React's own
};
const pass = (box) => box.dispatchEvent(new Event('input', {bubbles: true}));
const tell = (name, text) => {
  const id = document.getElementById('trackride-style')?.dataset[name];
  const label = document.querySelector(`label[for="${id}"]`);
  const sign = label?.closest('[data-trackride="page"] ~ div')?.querySelector('input');
  if (!sign) return setTimeout(() => trackrideInTurn(() => tell(name, text)), 100);  // the page is still being built
  set(sign, text);
  pass(sign);
};
// viser sends what is set in a page every 50 ms at most, and of what is set in between only the last: all that is told
// to the server takes its turn, here and in plots.js. A turn begins 100 ms after the one before it has begun, not when
// it was due: a busy page lets timers that are overdue run one right after the other.
window.trackrideInTurn ??= (() => {
  const waiting = [];
  let busy = false;
  const next = () => {
    const act = waiting.shift();
    busy = act !== undefined;
    if (!busy) return;
    setTimeout(next, 100);
    act();
  };
  return (act) => {
    waiting.push(act);
    if (!busy) setTimeout(next, 0);
    busy = true;
  };
})();
// A tab whose page is loaded anew goes on where it was, whatever other tabs of this browser have stored since
trackrideInTurn(() => tell('visit', sessionStorage.getItem('trackride') ?? 'null'));
trackrideInTurn(() => tell('place', sessionStorage.getItem('trackride-place') ?? 'null'));
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
  // A typed value counts at Enter, when the box is left, or after a pause, not key by key: until then React, which holds
  // the box's value in `defaultValue`, gets no word of it. What a box for numbers would misread (nothing, 4.7/2, a list,
  // many decimals) goes to the server as text, and the box shows what it showed before until the server knows better.
  const PAUSE = 1500;  // ms
  const BOXES = '.mantine-NumberInput-input, .mantine-TextInput-input, .mantine-Textarea-input';
  const timers = new Map();  // of the boxes with a text that does not count yet
  const row = (part) => part.querySelector('label[for]') ? part : row(part.parentElement);
  const drop = (box) => {
    clearTimeout(timers.get(box));
    return timers.delete(box);
  };
  let told = 0;
  const count = (box) => {
    if (!drop(box) || !box.isConnected || box.value === box.defaultValue) return;
    if (!box.matches('.mantine-NumberInput-input')) return pass(box);
    const text = box.value.trim(), number = String(Number(text));
    const {decimals} = document.getElementById('trackride-style').dataset;
    const plain = RegExp(`^-?\\d{1,12}(\\.\\d{1,${decimals}})?$`).test(number);
    const caret = box.selectionStart;
    set(box, box.defaultValue);
    if (plain && /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text)) {
      box.select();
      box.dispatchEvent(new KeyboardEvent('keydown', {bubbles: true}));  // at which it looks what is to be replaced
      set(box, number);
      pass(box);
      box.setSelectionRange(caret, caret);
    } else {
      trackrideInTurn(() => tell('typed', JSON.stringify([row(box).querySelector('label[for]').htmlFor, text, ++told])));
    }
  };
  const on = (names, act) => names.split(' ').forEach((name) => document.addEventListener(name, (event) => {
    if (event.isTrusted && event.target.matches?.(BOXES)) act(event.target, event);
  }, true));
  on('input', (box, event) => {
    event.stopImmediatePropagation();
    drop(box);
    timers.set(box, setTimeout(count, PAUSE, box));
  });
  on('change', (box, event) => {
    event.stopImmediatePropagation();
    count(box);
  });
  // A box that is left with a value beyond its slider would move to the slider's end. Any other must hear that it is
  // left: it takes the keys back at each new value else, as the player's box does while a run plays
  const beyond = (box) => {
    const slider = row(box).querySelector('[role="slider"]'), value = Number(box.value);
    return slider && (value < Number(slider.ariaValueMin) || value > Number(slider.ariaValueMax));
  };
  on('focusout', (box, event) => {
    count(box);
    if (beyond(box)) event.stopImmediatePropagation();
  });
  on('keydown', (box, {key}) => {
    if (key === 'Escape' && drop(box)) set(box, box.defaultValue);
    if (key === 'Enter' && box.tagName === 'INPUT'
      || ['ArrowUp', 'ArrowDown'].includes(key) && box.matches('.mantine-NumberInput-input'))
      count(box);
  });
  document.addEventListener('pointerdown', ({target}) => {
    for (const box of [...timers.keys()]) if (box !== target) count(box);
  }, true);
  // Hidden checkboxes, whose ids stand in the data of the style, carry what the page tells: a page in the background
  // takes the tick from one, and a browser that is set to dark pages gives the other its tick
  const tick = (name, on) => {
    const box = document.getElementById(document.getElementById('trackride-style')?.dataset[name]);
    if (box && box.checked !== on) box.click();
  };
  const wish = () => trackrideInTurn(() => tick('night', night.matches));
  document.addEventListener('visibilitychange', () => trackrideInTurn(() => tick('inView', !document.hidden)));
  const night = matchMedia('(prefers-color-scheme: dark)');
  night.addEventListener('change', wish);
  wish();
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
