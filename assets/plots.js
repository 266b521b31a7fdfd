// What the page itself does about the plots: marks (the time cursor, named frequencies), values at the cursor, zoom.
// viser lists its charts in __viserTestpoints.uplots; without that list there are no marks, but all curves.
// uPlot shares cursor and zoom among charts with the same sync key; one that appears later is given the zoom here.
if (!window.trackridePlots) {
  const met = new WeakSet();  // charts
  const groups = {};  // of charts, by their sync key: marks [[x, name], …] and zoom [from, to] as parts of the data's range
  const charts = () => Object.values(window.__viserTestpoints?.uplots ?? {}).map((entry) => entry.chart);
  const group = (key) => (key ?? '').startsWith('trackride-') ? groups[key] ??= {marks: [], zoom: [0, 1]} : undefined;
  const groupOf = (chart) => group(chart.cursor.sync?.key);
  const seen = (chart) => chart.width > 0;  // in a tab behind they are 0 px wide; asking for places would lay out the page

  const point = (chart) => {
    let layer = chart.over.querySelector('.trackride-marks');
    if (!layer) chart.over.append(layer = Object.assign(document.createElement('div'), {className: 'trackride-marks'}));
    const marks = groupOf(chart).marks, width = chart.bbox.width / devicePixelRatio;
    while (layer.children.length > marks.length) layer.lastChild.remove();
    while (layer.children.length < marks.length) layer.append(document.createElement('i'));
    marks.forEach(([at, name], k) => {
      const line = layer.children[k], x = chart.valToPos(at, 'x');
      line.style.transform = `translateX(${x}px)`;
      line.style.visibility = x >= -0.5 && x <= width + 0.5 ? '' : 'hidden';
      line.style.setProperty('--row', k);
      line.classList.toggle('left', x > 0.7 * width);
      line.dataset.name = name;
    });
  };
  const read = (chart) => {
    const [now, name] = groupOf(chart).marks[0] ?? [];
    if (name === '' && chart.cursor.left < 0) chart.setLegend({idx: chart.valToIdx(now)}, false);
  };
  const meet = (chart) => {
    met.add(chart);
    chart.root.classList.add(chart.cursor.sync.key);
    const shared = groupOf(chart), all = () => [chart.data[0][0], chart.data[0].at(-1)];
    const [from, to] = shared.zoom, [first, last] = all();  // also of all the data: viser makes some charts with 0…1
    chart.setScale('x', {min: first + from * (last - first), max: first + to * (last - first)});
    (chart.hooks.draw ??= []).push(() => {
      const [first, last] = all(), {min, max} = chart.scales.x;
      const drawn = last > first && max > min && seen(chart);
      if (drawn) shared.zoom = [(min - first) / (last - first), (max - first) / (last - first)];
      point(chart);
      requestAnimationFrame(() => read(chart));
    });
    chart.over.addEventListener('mouseleave', () => setTimeout(window.trackridePlots, 0));
  };
  let now = -1;  // s, of the time cursor
  const pointMaps = () => {  // each on its own: set for the whole page, it would be styled anew at every move
    for (const field of document.querySelectorAll('.trackride-map .field')) field.style.setProperty('--trackride-now', now);
  };
  window.trackridePlots = () => {
    const shown = charts().filter((chart) => groupOf(chart) && seen(chart));
    pointMaps();
    shown.forEach((chart) => {
      if (!met.has(chart)) meet(chart);
      point(chart);
      read(chart);
    });
  };
  customElements.define('trackride-marks', class extends HTMLElement {
    connectedCallback() {
      const marks = JSON.parse(this.getAttribute('at'));
      group(this.getAttribute('for')).marks = marks;
      if (marks[0]?.[1] === '') now = marks[0][0];
      window.trackridePlots();
    }
  });
  setInterval(window.trackridePlots, 250);
}
