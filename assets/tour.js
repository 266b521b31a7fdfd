// The tour of the page, which a browser shows by itself once, and the card of an example that runs in the page. Neither
// blocks anything: what the tour points at can be used meanwhile; a click elsewhere, "Skip" or Esc ends it.
if (!window.trackrideTour) {
  const SEEN = 'trackride-toured', PANEL = '[data-trackride="panel"]';
  const all = (css) => [...document.querySelectorAll(css)];
  const shown = (part) => part?.getClientRects().length > 0;
  const tab = (name) => all('[role="tab"]').filter((one) => one.textContent === name);
  const folder = (name) => all(`${PANEL} [data-trackride-folder] > [role="button"]`).filter((one) => one.textContent === name);
  const sliders = () => all(`${PANEL} .mantine-Slider-root`).filter((one) => !one.closest('[data-trackride-folder]'))
    .flatMap((one) => [one.parentElement, ...all(`${PANEL} label[for="${one.id}"]`)]);
  // What each step points at: lists of parts, each list with a frame of its own; the card stands beside the first,
  // or below it
  const STEPS = [
    {
      title: 'Drag a slider',
      text: 'Each change is a new run of the whole vehicle, in milliseconds: all curves follow your hand. Try it now.',
      at: () => [sliders()],
    },
    {
      title: 'The vehicle on its road',
      text: 'Arrows are the loads under the wheels; a wheel without one is in the air. Drag to look from elsewhere, and '
        + 'click a wheel for its figures. Space plays and pauses.',
      at: () => [all('[data-trackride="view"]')],
    },
    {
      title: 'The whole run at a glance',
      text: 'Click in a plot to go to that time; drag across it to zoom. Further tabs have the ride, spectra and load maps.',
      at: () => [all('[data-dock-region="right"]')],
    },
    {
      title: 'What every slider would do',
      text: 'The thin curve on a slider shows one figure over its range, before you move it. The tab Study draws this for '
        + 'more parameters and figures.',
      at: () => [tab('Study'), sliders()],
      below: true,
    },
    {
      title: 'Compare, and pass it on',
      text: 'B pins the run: its curves stay, pale, and the tab Runs lists what changes. Export has figures, data and '
        + 'films; Shift+C copies a link to what you see.',
      at: () => [folder('Export'), tab('Runs')],
    },
  ];
  const GAP = 14;
  let examples = [], step = -1, card = null, frames = [], before = null, timer = 0;
  const make = (name, attributes = {}, ...parts) => {
    const made = Object.assign(document.createElement(name), attributes);
    made.append(...parts);
    return made;
  };
  const button = (text, act, className = '') => make('button', {type: 'button', textContent: text, onclick: act, className});
  const around = (parts) => {  // the rectangle that holds them, within the page
    const boxes = parts.filter(shown).map((part) => part.getBoundingClientRect());
    if (!boxes.length) return null;
    const [left, top] = ['left', 'top'].map((side) => Math.max(Math.min(...boxes.map((box) => box[side])), 0));
    const right = Math.min(Math.max(...boxes.map((box) => box.right)), innerWidth);
    const bottom = Math.min(Math.max(...boxes.map((box) => box.bottom)), innerHeight);
    return {left, top, right, bottom};
  };
  const place = () => {
    const boxes = STEPS[step].at().map(around);
    frames.forEach((frame, k) => {
      const box = boxes[k], inside = 3;  // px: a frame at the edge of the page is seen, too
      frame.hidden = !box;
      if (!box) return;
      const [left, top] = [Math.max(box.left - inside, 1), Math.max(box.top - inside, 1)];
      Object.assign(frame.style, {
        left: `${left}px`, top: `${top}px`,
        width: `${Math.min(box.right + inside, innerWidth - 1) - left}px`,
        height: `${Math.min(box.bottom + inside, innerHeight - 1) - top}px`,
      });
    });
    const box = boxes.find(Boolean), {offsetWidth: wide, offsetHeight: high} = card;
    let [x, y] = [(innerWidth - wide) / 2, (innerHeight - high) / 2];
    if (box) {
      const middle = (box.top + box.bottom - high) / 2, centre = (box.left + box.right - wide) / 2;
      const spots = [
        [box.right + GAP, middle, box.right + GAP + wide < innerWidth], [box.left - GAP - wide, middle, box.left - GAP > wide],
        [centre, box.bottom + GAP, box.bottom + GAP + high < innerHeight], [centre, box.top - GAP - high, box.top - GAP > high],
      ];
      if (STEPS[step].below) spots.unshift(spots[2]);
      [x, y] = spots.find(([, , fits]) => fits) ?? [centre, box.top + 3 * GAP];
    }
    card.style.left = `${Math.min(Math.max(x, GAP), innerWidth - wide - GAP)}px`;
    card.style.top = `${Math.min(Math.max(y, GAP), innerHeight - high - GAP)}px`;
  };
  const end = () => {
    if (step < 0) return;
    step = -1;
    clearInterval(timer);
    const had = card.contains(document.activeElement);
    [card, ...frames].forEach((part) => part.remove());
    frames = [];
    if (had && before?.isConnected) before.focus();
  };
  const go = (to) => {
    const byKeys = document.activeElement.matches('.trackride-card button:focus-visible');
    step = to;
    const {title, text, at} = STEPS[step], last = step === STEPS.length - 1;
    frames.forEach((frame) => frame.remove());
    frames = at().map(() => make('div', {className: 'trackride-frame', hidden: true}));
    document.body.append(...frames);
    card.setAttribute('aria-label', `Tour of the page, step ${step + 1} of ${STEPS.length}`);
    const tries = make('p', {className: 'trackride-tries'}, 'Try it: ', ...examples.map((name) => {
      const one = button(name);
      one.dataset.trackrideTry = name;
      return one;
    }));
    const next = last ? button('Done', end, 'main') : button('Next', () => go(step + 1), 'main');
    const back = button('Back', () => go(step - 1));
    back.disabled = step === 0;
    card.replaceChildren(
      make('h2', {textContent: title}), make('p', {textContent: text}), ...last ? [tries] : [],
      make('footer', {}, make('span', {textContent: `${step + 1} of ${STEPS.length}`}), button('Skip', end), back, next),
    );
    at().flat()[0]?.scrollIntoView({block: 'nearest'});
    place();
    if (document.activeElement === document.body) (byKeys ? next : card).focus();  // else the user is at something
  };
  const start = (asked = true) => {
    end();
    try { localStorage.setItem(SEEN, 'yes'); } catch { /* it may not be kept */ }
    before = document.activeElement;
    if (asked) before.blur();
    card = make('div', {className: 'trackride-card', tabIndex: -1});
    Object.entries({role: 'dialog', 'aria-live': 'polite'}).forEach(([name, value]) => card.setAttribute(name, value));
    document.body.append(card);
    go(0);
    timer = setInterval(place, 200);
  };
  window.trackrideTour = start;
  window.addEventListener('resize', () => step < 0 || place());
  document.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || step < 0 || document.querySelector('.mantine-Spotlight-body')) return;
    event.stopImmediatePropagation();
    end();
  }, true);
  document.addEventListener('pointerdown', ({target, clientX: x, clientY: y}) => {
    if (step < 0 || card.contains(target)) return;
    const pointed = STEPS[step].at().map(around).some((box) =>
      box && box.left <= x && x <= box.right && box.top <= y && y <= box.bottom);
    if (!pointed) end();
  }, true);
  document.addEventListener('click', ({target}) => {
    const {trackrideTry: what} = target.closest?.('[data-trackride-try]')?.dataset ?? {};
    if (!what) return;
    if (what === 'tour') return start();
    end();
    trackrideAsk('example', what);
  });
  // viser may put an element into the page twice: only another count is another start
  let starts = '0';
  customElements.define('trackride-tour', class extends HTMLElement {
    connectedCallback() {
      examples = JSON.parse(this.getAttribute('examples'));
      if (this.getAttribute('starts') !== starts && (starts = this.getAttribute('starts')) !== '0') setTimeout(start);
    }
  });
  let example = null;  // its card
  const placeExample = () => {
    const view = around(all('[data-trackride="view"]')) ?? {left: 0, right: innerWidth, top: 0};
    example.style.maxWidth = `${Math.max(view.right - view.left - 2 * GAP, 240)}px`;
    example.style.left = `${Math.max((view.left + view.right - example.offsetWidth) / 2, GAP)}px`;
    const notices = around(all('.mantine-Notification-root'));  // the card stands below them
    example.style.top = `${Math.max(view.top, notices ? notices.bottom : 0) + GAP}px`;
  };
  setInterval(() => example && placeExample(), 200);
  customElements.define('trackride-example', class extends HTMLElement {
    connectedCallback() {
      const [name, says] = ['name', 'says'].map((word) => this.getAttribute(word));
      if (!name) {
        example?.remove();
        example = null;
        return;
      }
      if (!example) {
        example = make('div', {className: 'trackride-card trackride-example'});
        example.setAttribute('role', 'status');
        document.body.append(example);
      }
      example.setAttribute('aria-label', `Example: ${name}`);
      const ended = this.hasAttribute('ended');
      example.replaceChildren(
        make('h2', {textContent: name}), make('p', {textContent: says}),
        make('footer', {}, make('span', {textContent: ended ? 'Example' : 'Example: under way'}),
          button('Undo example', () => trackrideAsk('undo example', '')),
          ...ended ? [button('Keep', () => trackrideAsk('keep example', ''), 'main')] : []),
      );
      placeExample();
    }
  });
  const unseen = () => {
    try { return !localStorage.getItem(SEEN); } catch { return false; }
  };
  if (unseen()) {
    const wait = setInterval(() => {  // until the first run is there
      if (!document.querySelector('.uplot canvas') || !sliders().some(shown)) return;
      clearInterval(wait);
      if (unseen() && step < 0) start(false);
    }, 300);
  }
}
