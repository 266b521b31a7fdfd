// The table of figures in the tab "Runs": wheels of a figure unfold at a click, and the figures stand in the order of the
// table or by their change. Both stay as they are when the table comes anew.
if (!customElements.get('trackride-figures')) {
  const open = new Set();
  let byChange = false;
  customElements.define('trackride-figures', class extends HTMLElement {
    connectedCallback() {
      const table = this.querySelector('table'), bodies = [...table.tBodies];
      for (const body of bodies) body.querySelector('button')?.addEventListener('click', () => {
        open[open.has(body.dataset.figure) ? 'delete' : 'add'](body.dataset.figure);
        this.show(table, bodies);
      });
      if (this.hasAttribute('compared')) {
        const head = table.tHead.rows[0].cells[3], button = document.createElement('button');
        button.type = 'button';
        head.replaceChildren(button);
        button.addEventListener('click', () => {
          byChange = !byChange;
          this.show(table, bodies);
        });
        button.title = 'Largest changes first, or all figures in their order';
      }
      this.show(table, bodies);
    }
    show(table, bodies) {
      const sorted = byChange ? bodies.toSorted((one, other) => other.dataset.change - one.dataset.change) : bodies;
      sorted.forEach((body) => {
        table.append(body);
        const unfolded = open.has(body.dataset.figure);
        body.classList.toggle('open', unfolded);
        body.querySelector('button')?.setAttribute('aria-expanded', unfolded);
      });
      const button = table.tHead.querySelector('button');
      if (button) {
        button.textContent = byChange ? 'change ▾' : 'change ⇅';
        button.setAttribute('aria-pressed', byChange);
      }
    }
  });
}
