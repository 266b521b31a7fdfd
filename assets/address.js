// The address follows what the page shows, and the browser's back button leads through its states: a step of its own for
// each state that the user rests in. Another fragment, from there or typed, is asked of the server.
if (!customElements.get('trackride-address')) {
  let last;  // step that the address shows
  customElements.define('trackride-address', class extends HTMLElement {
    connectedCallback() {
      const of = this.getAttribute('of'), step = this.getAttribute('step');
      const address = location.pathname + location.search + (of && `#${of}`);
      if (location.hash.slice(1) !== of)
        history[last === undefined || step === last ? 'replaceState' : 'pushState'](history.state, '', address);
      last = step;
    }
  });
  window.addEventListener('hashchange', () => {
    if (location.hash.length > 1) trackrideAsk('link', location.hash.slice(1));
  });
  customElements.define('trackride-copy', class extends HTMLElement {
    connectedCallback() {
      const text = `${location.origin}${location.pathname}#${this.getAttribute('of')}`;
      const byHand = () => {  // where the browser does not let a page write there: over plain http from elsewhere
        const box = Object.assign(document.createElement('textarea'), {value: text});
        document.body.append(box);
        box.select();
        document.execCommand('copy');
        box.remove();
      };
      navigator.clipboard ? navigator.clipboard.writeText(text).catch(byHand) : byHand();
    }
  });
}
