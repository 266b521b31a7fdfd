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
  const next = () => {  // the next one waits from when this one was told: a busy page runs timers late, and all at once
    const act = waiting.shift();
    busy = act !== undefined;
    if (busy) setTimeout(next, 100);
    act?.();
  };
  return (act) => {
    waiting.push(act);
    if (busy) return;
    busy = true;
    setTimeout(next, 0);
  };
})();
window.trackrideTell = tell;  // for plots.js
let asks = 0;
window.trackrideAsk = (kind, content) => trackrideInTurn(() => tell('asked', JSON.stringify({kind, content, count: ++asks})));
// What its address asked for when it was opened (head.html) comes first
if (window.trackrideOpened) trackrideAsk('link', trackrideOpened);
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
  // Names and roles that viser's parts lack: screen readers say them, and folders are reached by Tab. Looked at four
  // times a second, since viser makes parts anew: what has its name already is let alone
  const KEYS = {arrowright: '→', arrowleft: '←', space: 'Space'};  // as the palette is to write them
  const give = (part, attributes) => Object.entries(attributes).forEach(([name, value]) => {
    if (part && part.getAttribute(name) !== value) part.setAttribute(name, value);
  });
  const nameParts = () => {
    document.querySelectorAll('label[for]').forEach((label) => {
      const name = label.textContent, part = document.getElementById(label.htmlFor);
      if (part?.matches('.mantine-Slider-root')) {
        give(part.querySelector('[role="slider"]'), {'aria-label': name});
        give(part.parentElement.querySelector('input[type="text"]'), {'aria-label': `${name}, as a number`});
      } else if (!part) {
        const beside = label.closest('div[style]')?.nextElementSibling;
        give(beside?.querySelector('button')?.parentElement, {role: 'group', 'aria-label': name});
        give(beside?.querySelector('input, textarea'), {'aria-label': name});
      }
    });
    document.querySelectorAll('button').forEach((button) => {
      const [sign, name] = button.textContent.trim().split(' ');
      if (['●', '○'].includes(sign) && name) give(button, {'aria-pressed': String(sign === '●'), 'aria-label': name});
      const said = {'✕': 'Forget this run', '|◀': 'To the start'}[button.textContent];
      if (said) give(button, {'aria-label': said});
      else if (['Forget this run', 'To the start'].includes(button.ariaLabel)) button.removeAttribute('aria-label');
    });
    for (const [icon, name] of [
      ['list-search', 'All commands and their keys'], ['adjustments', 'Settings of viser'], ['maximize', 'This plot alone'],
    ]) document.querySelectorAll(`.tabler-icon-${icon}`).forEach((drawn) => give(drawn.closest('button'), {
      'aria-label': name, 'data-trackride-icon': icon,
    }));
    const arrows = '[data-trackride="panel"] .mantine-Paper-root svg[class*="tabler-icon-chevron-"]';
    document.querySelectorAll(arrows).forEach((arrow) => {
      const open = arrow.classList.contains('tabler-icon-chevron-up');
      give(arrow, {'aria-hidden': 'true'});
      give(arrow.parentElement.parentElement, {'data-trackride-folder': open ? 'open' : 'closed'});
      give(arrow.parentElement, {role: 'button', tabindex: '0', 'aria-expanded': String(open)});
    });
    document.querySelectorAll('.mantine-CloseButton-root').forEach((button) => give(button, {'aria-label': 'Close'}));
    document.querySelectorAll('canvas[data-engine]').forEach((canvas) => give(canvas, {
      role: 'img', 'aria-label': 'The vehicle on its road, in three dimensions',
    }));
    const commands = document.querySelector('.mantine-Spotlight-body') ?? new Text();
    const palette = document.createTreeWalker(commands, NodeFilter.SHOW_TEXT);
    while (palette.nextNode()) {
      const {currentNode: text} = palette;
      const plain = text.data.replace(/\b(arrowright|arrowleft|space)$/, (key) => KEYS[key]);
      if (text.data !== plain) text.data = plain;
    }
  };
  setInterval(nameParts, 250);
  document.addEventListener('keyup', nameParts);  // of the palette, which filters at each key
  document.addEventListener('keydown', (event) => {
    if (['Enter', ' '].includes(event.key) && event.target.matches?.('[data-trackride-folder] > [role="button"]')) {
      event.preventDefault();
      event.stopImmediatePropagation();
      event.target.click();
    }
  }, true);
  // A hint stands beside the panel that its control is in, and goes at the first click or key until the pointer moves on
  let hinted = null;  // row of the control that the pointer is on
  const rowOf = (part) => {
    const label = part.closest?.('div[style*="flex-shrink"]');
    return label?.parentElement ?? part.closest?.('.mantine-Flex-root, button') ?? null;
  };
  document.addEventListener('mouseover', ({target}) => {
    const on = rowOf(target);
    if (on === hinted) return;
    hinted = on;
    delete root.dataset.trackrideBusy;
  });
  const quiet = () => root.dataset.trackrideBusy = '';
  document.addEventListener('pointerdown', quiet, true);
  document.addEventListener('keydown', quiet, true);
  const placeHint = () => {
    const hint = document.querySelector('.mantine-Tooltip-tooltip');
    const owner = hint && (document.querySelector(`[aria-describedby="${hint.id}"]`) ?? hinted);
    if (!owner) return;
    const row = (rowOf(owner) ?? owner).getBoundingClientRect(), {offsetWidth: wide, offsetHeight: high} = hint, GAP = 12;
    const panel = (owner.closest('[data-dock-region], .mantine-Paper-root:not(.mantine-Paper-root *)') ?? owner)
      .getBoundingClientRect();
    let [x, y] = [panel.right + GAP, row.top];
    if (x + wide > innerWidth) x = panel.left - wide - GAP;
    if (x < 0 || panel.width > 0.6 * innerWidth) [x, y] = [row.left, row.top - high - GAP];
    if (y < 0) y = row.bottom + GAP;
    root.style.setProperty('--trackride-hint-x', `${Math.min(Math.max(x, 4), innerWidth - wide - 4)}px`);
    root.style.setProperty('--trackride-hint-y', `${Math.min(Math.max(y, 4), innerHeight - high - 4)}px`);
  };
  const hints = new MutationObserver(placeHint);
  const watchHints = () => document.querySelectorAll('[data-portal="true"]:not([data-trackride])').forEach((portal) => {
    portal.dataset.trackride = 'hints';
    hints.observe(portal, {childList: true});
  });
  setInterval(watchHints, 250);
  // The size of the page and the width of the view, px: the server shares the page among the panels and tells how
  const {documentElement: root} = document;
  const view = () => root.querySelector('canvas[data-engine]')?.parentElement ?? root;
  let told_size = '';
  const tellSize = () => {
    const size = JSON.stringify([innerWidth, innerHeight, view().clientWidth]);
    if (size !== told_size) trackrideInTurn(() => tell('size', told_size = size));
  };
  customElements.define('trackride-layout', class extends HTMLElement {
    connectedCallback() {
      const [of, scale, plots, columns, left, height] =
        ['for', 'scale', 'plots', 'columns', 'left', 'height'].map((name) => this.getAttribute(name));
      [root.dataset.plots, root.dataset.columns] = [plots, columns];
      Object.entries({scale, columns, left: `${left}px`, height: `${height}px`})
        .forEach(([name, value]) => root.style.setProperty(`--trackride-${name}`, value));
      view().closest('div[style*="inset"], div[style*="bottom: 0px"]')?.setAttribute('data-trackride', 'view');
      if (of === `${innerWidth} ${innerHeight}`) root.dataset.trackrideStands = '';
    }
  });
  window.addEventListener('resize', tellSize);
  setInterval(tellSize, 250);  // a seam that is moved changes the view only
  tellSize();
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
