// Marks on the rows of the parameters: what is changed, each with its own reset; and a star that puts a parameter among
// the first sliders or takes it out again. Which ones these are the browser keeps.
if (!customElements.get('trackride-rows')) {
  const KEPT = 'trackride-first';
  let rows = {}, changes = {};
  let sought;  // count of the last search: viser may put its element into the page twice
  const kept = () => {
    try { return JSON.parse(localStorage.getItem(KEPT)) ?? []; } catch { return []; }
  };
  const button = (place, kind) => {
    const found = place.querySelector(`.trackride-${kind}`);
    if (found) return found;
    const made = Object.assign(document.createElement('button'), {type: 'button', className: `trackride-${kind}`});
    place.append(made);
    return made;
  };
  const say = (part, text, title) => {
    if (part.textContent !== text) part.textContent = text;
    if (part.title !== title) {
      part.title = title;
      part.setAttribute('aria-label', title);
    }
  };
  const draw = () => document.querySelectorAll('[data-trackride="panel"] label[for]').forEach((label) => {
    const row = rows[label.htmlFor], place = label.closest('div[style*="flex-shrink"]');
    if (!row || !place) return;
    const [key, free, first] = row, was = changes[key], name = label.textContent.split(',')[0];
    place.classList.toggle('trackride-changed', was !== undefined);
    const reset = button(place, 'reset');  // always there, so that nothing appears in a drag
    reset.style.visibility = was === undefined ? 'hidden' : '';
    say(reset, '↺', `${name} back to ${was}`);
    reset.onclick = () => trackrideAsk('reset', key);
    if (!free) return;
    const star = button(place, 'star');
    say(star, first ? '★' : '☆', first ? `${name} no longer among the first sliders` : `${name} among the first sliders, too`);
    star.setAttribute('aria-pressed', first);
    star.onclick = () => {
      const others = kept().filter((one) => one !== key);
      const now = first ? others : [...others, key];
      localStorage.setItem(KEPT, JSON.stringify(now));
      trackrideAsk('first', now);
    };
  });
  customElements.define('trackride-rows', class extends HTMLElement {
    connectedCallback() {
      rows = JSON.parse(this.getAttribute('of'));
      draw();
    }
  });
  customElements.define('trackride-changes', class extends HTMLElement {
    connectedCallback() {
      changes = JSON.parse(this.getAttribute('of'));
      draw();
    }
  });
  customElements.define('trackride-sought', class extends HTMLElement {
    connectedCallback() {
      const row = document.querySelector(`label[for="${this.getAttribute('box')}"]`)?.closest('div[style*="flex-shrink"]')?.parentElement;
      if (!row || this.getAttribute('count') === sought) return;
      sought = this.getAttribute('count');
      setTimeout(() => {  // not now: React, which puts this in, heeds no click meanwhile
        for (let part = row.parentElement; part; part = part.parentElement)
          if (part.matches('[data-trackride-folder]'))  // what it says may be old by a quarter of a second; its arrow is not
            part.querySelector(':scope > [role="button"]:has(> svg[class*="chevron-down"])')?.click();
      });
      const input = row.querySelector('[role="slider"], input, textarea, button');
      setTimeout(() => {  // once the folder is open
        row.scrollIntoView({block: 'center'});
        input?.focus();
        row.classList.add('trackride-found');
        setTimeout(() => row.classList.remove('trackride-found'), 2000);
      }, 300);
    }
  });
  customElements.define('trackride-front', class extends HTMLElement {
    connectedCallback() {
      const tab = [...document.querySelectorAll('[role="tab"]')].find((tab) => tab.textContent === this.getAttribute('of'));
      setTimeout(() => tab?.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true})));  // as above
    }
  });
  setInterval(draw, 500);  // viser makes rows anew
  if (kept().length) trackrideAsk('first', kept());
}
