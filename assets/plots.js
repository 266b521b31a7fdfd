// What the page itself does about the plots: marks (the time cursor, named frequencies), values at the cursor, zoom,
// curves that are hidden with a click on their name, what the tools above the plots say of their shape, telling which
// tabs are in front, and plots by keyboard.
// viser lists its charts in __viserTestpoints.uplots; without that list there are no marks, but all curves.
// uPlot shares cursor and zoom among charts with the same sync key that are in view; one that comes into view later is
// given the zoom here, and so are the load maps.
if (!window.trackridePlots) {
  const TIME = 'trackride-time';
  const finer = JSON.parse(this.dataset.finer);  // decimals that values in a unit have more than in others, by the unit
  const more = (chart) => finer[chart.axes[1].label] ?? 0;
  const met = new WeakSet(), inView = new WeakSet();  // charts
  const groups = {};  // of charts, by their sync key: marks [[x, name], …], zoom [from, to] as parts of the data's range,
                      // and window [from, to] of x, or null
  const hidden = {};  // names of curves, by the chart's unit and curves: they stay so when a chart is made anew
  const charts = () => Object.values(window.__viserTestpoints?.uplots ?? {}).map((entry) => entry.chart);
  const group = (key) => (key ?? '').startsWith('trackride-') ? groups[key] ??= {marks: [], zoom: [0, 1]} : undefined;
  const groupOf = (chart) => group(chart.cursor.sync?.key);
  const seen = (chart) => chart.width > 0;  // in a tab behind they are 0 px wide; asking for places would lay out the page
  const ends = (chart) => [chart.data[0][0], chart.data[0].at(-1)];

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
  const frame = (chart) => {  // two thin lines at the ends of the stretch that figures are taken from
    const span = groupOf(chart).window;
    let layer = chart.over.querySelector('.trackride-window');
    if (!span) return layer?.remove();
    if (!layer) {
      chart.over.append(layer = Object.assign(document.createElement('div'), {className: 'trackride-window'}));
      layer.append(document.createElement('b'));
    }
    const [from, to] = span.map((at) => chart.valToPos(at, 'x')), {style} = layer.firstChild;
    [style.left, style.width] = [`${from}px`, `${to - from}px`];
  };
  const read = (chart) => {
    const [now, name] = groupOf(chart).marks[0] ?? [];
    if (name === '' && chart.cursor.left < 0) chart.setLegend({idx: chart.valToIdx(now)}, false);
  };
  // Where the cursor of time stands between the points that are drawn, the value lies on the line between them.
  const valueOf = (chart, value, k, idx) => {
    const x = chart.data[0], [now, name] = groupOf(chart)?.marks[0] ?? [];
    if (!Number.isFinite(value) || k === 0) return null;
    if (name === '' && chart.cursor.left < 0) {
      const on = x[idx] < now ? idx + 1 : idx - 1, part = (now - x[idx]) / (x[on] - x[idx]), other = chart.data[k][on];
      if (part > 0 && Number.isFinite(other)) value += part * (other - value);
    }
    const {min, max} = chart.scales.y;
    const most = (name === '' ? 2 : 4) + more(chart);  // decimals that the values have
    const digits = Math.min(Math.max(Math.ceil(3 - Math.log10(max - min)), 0), most);  // to a thousandth of the axis
    return (Number(value.toFixed(digits)) + 0).toFixed(digits);  // no minus before zero
  };
  const zoom = (chart) => {
    const [from, to] = groupOf(chart).zoom, [first, last] = ends(chart), {min, max} = chart.scales.x;
    const low = from < 1e-6 ? first : first + from * (last - first);  // to the very end: it may have a number on the axis
    const high = to > 1 - 1e-6 ? last : first + to * (last - first);
    const shown = Math.abs(low - min) + Math.abs(high - max) <= 1e-6 * (last - first);  // viser makes some charts with 0…1
    if (!shown) chart.setScale('x', {min: low, max: high});
  };
  const isRun = (curve) => curve.class === 'run';
  const kin = (chart) => {  // a baseline's curve is hidden with the run's
    const runs = chart.series.filter(isRun);
    const gone = hidden[[chart.axes[1].label, ...runs.map((curve) => curve.label)]] ??= new Set();
    return [runs, gone];
  };
  const hide = (chart) => chart.series.forEach(({label, show, class: kind}, k) => {
    const wanted = !kin(chart)[1].has(label);
    if ((kind === 'run' || kind === 'baseline') && show !== wanted) chart.setSeries(k, {show: wanted});
  });
  // Without a graphics processor a line of 1 px is drawn many times faster than a wider one. Three of them, a quarter of
  // a pixel apart, look like 1.5 px; pale ones would only become darker. Curves of many points, which go up and down all
  // the time (rough ground), stay thin: they would cover each other.
  const AROUND = [[-0.3, 0], [0.15, -0.26], [0.15, 0.26]];
  const CROWD = 450;  // points of a curve in view
  const isClear = (chart, k) => isRun(chart.series[k]) && /^#\w{6}$/.test(chart.series[k].stroke(chart, k));
  const thicken = (chart, k) => {
    const curve = chart.series[k], draw = curve.paths;
    if (k === 0) return;
    curve.paths = (...all) => {
      const paths = draw(...all);
      if (!paths) return paths;
      if (shapeOf(chart) !== 'curves') return {...paths, stroke: new Path2D()};  // `reshape` draws
      if (!isClear(chart, k)) return paths;
      let {stroke} = paths;
      if (all[3] - all[2] < CROWD) {
        stroke = new Path2D();
        AROUND.forEach(([e, f]) => stroke.addPath(paths.stroke, {e, f}));
      }
      curve.drawn = stroke;
      return {...paths, stroke};
    };
  };
  // The tools above the plots: in which shape curves are drawn, and whether their names stand at their ends. By itself,
  // curves that crowd (rough ground) become strips
  const look = {shape: 'auto', names: false, ...JSON.parse(sessionStorage.getItem('trackride-plots') ?? '{}')};
  const shownRuns = (chart) => chart.series.flatMap((curve, k) => isRun(curve) && curve.show ? [k] : []);
  const shapeOf = (chart) => {
    const [from, to] = chart.series[0].idxs ?? [0, 0];
    if (chart.cursor.sync.key !== TIME || shownRuns(chart).length < 3) return 'curves';
    return look.shape !== 'auto' ? look.shape : crowds(chart, from, to) ? 'strips' : 'curves';
  };
  // Curves crowd where they turn, by more than a thirtieth of all, more than once in 8 px
  const judged = new WeakMap();  // chart -> for what it was looked at last, and the answer
  const crowds = (chart, from, to) => {
    const runs = shownRuns(chart), what = [chart.data[0], from, to, chart.width, runs.length], last = judged.get(chart);
    if (last?.what.every((part, k) => part === what[k])) return last.answer;
    const values = runs.map((k) => chart.data[k].slice(from, to + 1));
    let low = Infinity, high = -Infinity, turns = 0;
    values.forEach((curve) => curve.forEach((value) => { low = Math.min(low, value); high = Math.max(high, value); }));
    values.forEach((curve) => {
      let end = curve[0], up = 0;
      curve.forEach((value) => {
        if (up * (value - end) >= 0 && up) return end = value;
        if (Math.abs(value - end) * 30 < high - low) return;
        turns += up ? 1 : 0;
        [up, end] = [Math.sign(value - end), value];
      });
    });
    const answer = turns / runs.length > chart.bbox.width / devicePixelRatio / 8;
    judged.set(chart, {what, answer});
    return answer;
  };
  const stretch = (chart) => {  // numbers of the points in view, one more at both ends
    const [from, to] = chart.series[0].idxs, first = Math.max(from - 1, 0), last = Math.min(to + 1, chart.data[0].length - 1);
    return Array.from({length: last - first + 1}, (_, k) => first + k);
  };
  const lineOf = (chart, k, points, place) => {
    const path = new Path2D();
    let begun = false;
    points.forEach((point) => {
      const value = typeof k === 'function' ? k(point) : chart.data[k][point];
      if (!Number.isFinite(value)) return begun = false;
      const at = [chart.valToPos(chart.data[0][point], 'x', true), place(value)];
      begun ? path.lineTo(...at) : path.moveTo(...at);
      begun = true;
    });
    return path;
  };
  const inPlot = (chart, draw) => {
    const {ctx, bbox: {left, top, width, height}} = chart;
    ctx.save();
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    ctx.setLineDash([]);
    [ctx.lineWidth, ctx.lineJoin] = [1.25 * devicePixelRatio, 'round'];
    draw(ctx);
    ctx.restore();
  };
  const letters = (chart) => parseFloat(chart.axes[0].font[0] ?? chart.axes[0].font) || 11 * devicePixelRatio;  // canvas px
  const write = (chart, text, x, y, colour, align) => {
    const {ctx} = chart;
    ctx.save();  // uPlot takes what it has set last for what is set
    [ctx.font, ctx.textAlign, ctx.textBaseline] = [`600 ${letters(chart)}px system-ui, sans-serif`, align, 'middle'];
    [ctx.strokeStyle, ctx.lineWidth] = [getComputedStyle(document.body).backgroundColor, 3 * devicePixelRatio];
    ctx.lineJoin = 'round';
    ctx.strokeText(text, x, y);
    ctx.fillStyle = colour;
    ctx.fillText(text, x, y);
    ctx.restore();
  };
  const drawStrips = (chart) => {  // one below the other, all with the same scale, over what uPlot has drawn
    const {ctx, bbox: {left, top, width, height}} = chart, runs = shownRuns(chart), points = stretch(chart);
    const values = runs.flatMap((k) => points.map((point) => chart.data[k][point])).filter(Number.isFinite);
    const low = Math.min(...values), high = Math.max(...values, low + 1e-9), each = height / runs.length;
    const axis = chart.axes[1], px = devicePixelRatio, {stroke} = chart.axes[1].grid, labelled = (axis.labelSize ?? 0) * px;
    ctx.clearRect(labelled, top - 8 * px, left + width - labelled + 2 * px, height + 8 * px);
    ctx.clearRect(labelled, top + height, left - 5 * px - labelled, 7 * px);  // the lower half of the lowest number
    ctx.save();
    ctx.setLineDash([]);
    [ctx.strokeStyle, ctx.lineWidth] = ['#80808040', px];
    ctx.beginPath();
    (chart.axes[0]._splits ?? []).forEach((time) => {
      const x = chart.valToPos(time, 'x', true);
      if (x >= left && x <= left + width) { ctx.moveTo(x, top); ctx.lineTo(x, top + height); }
    });
    runs.forEach((_, row) => {
      ctx.moveTo(left, top + (row + 1) * each);
      ctx.lineTo(left + width, top + (row + 1) * each);
    });
    ctx.stroke();
    runs.forEach((k, row) => {
      const place = (value) => top + (row + 1) * each - (0.06 + 0.88 * (value - low) / (high - low)) * each;
      const other = chart.series.findIndex((it) => it.class === 'baseline' && it.label === chart.series[k].label);
      inPlot(chart, () => {
        for (const curve of [other, k].filter((number) => number > 0)) {
          ctx.setLineDash(curve === other ? [4 * px, 3 * px] : []);
          ctx.strokeStyle = chart.series[curve].stroke(chart, curve);
          ctx.stroke(lineOf(chart, curve, points, place));
        }
      });
      const {label} = chart.series[k], colour = chart.series[k].stroke(chart, k);
      write(chart, label, left - 6 * px, top + (row + 0.5) * each, colour, 'right');
    });
    const text = `each strip: ${+low.toPrecision(3)} … ${+high.toPrecision(3)} ${axis.label}`.replaceAll('-', '−');
    write(chart, text, left + width - 2 * px, top - 2 * px, axis.stroke(chart, 1), 'right');
    ctx.restore();
  };
  const drawBand = (chart) => {  // from the least to the largest of all wheels, and their mean
    const {ctx} = chart, runs = shownRuns(chart), points = stretch(chart), place = (value) => chart.valToPos(value, 'y', true);
    const all = (numbers) => (point) => numbers.map((k) => chart.data[k][point]);
    const mean = (numbers) => (point) => all(numbers)(point).reduce((sum, value) => sum + value, 0) / numbers.length;
    const colour = chart.series[runs[Math.floor(runs.length / 2)]].stroke(chart, runs[0]).slice(0, 7);
    inPlot(chart, () => {
      const band = new Path2D(), at = (point) => chart.valToPos(chart.data[0][point], 'x', true);
      const edge = (of, point) => [at(point), place(of(...all(runs)(point)))];
      points.forEach((point, k) => k ? band.lineTo(...edge(Math.max, point)) : band.moveTo(...edge(Math.max, point)));
      [...points].reverse().forEach((point) => band.lineTo(...edge(Math.min, point)));
      ctx.fillStyle = `${colour}40`;
      ctx.fill(band);
      ctx.strokeStyle = colour;
      ctx.lineWidth *= 1.4;
      ctx.stroke(lineOf(chart, mean(runs), points, place));
      const others = chart.series.flatMap((curve, k) => curve.class === 'baseline' && curve.show ? [k] : []);
      ctx.setLineDash([4 * devicePixelRatio, 3 * devicePixelRatio]);
      ctx.globalAlpha = 0.7;
      if (others.length) ctx.stroke(lineOf(chart, mean(others), points, place));
    });
    write(chart, `mean and range of ${runs.length} wheels`, chart.bbox.left + chart.bbox.width - 2 * devicePixelRatio,
      chart.bbox.top + letters(chart), chart.axes[1].stroke(chart, 1), 'right');
  };
  const drawNames = (chart) => {  // at the curves' right ends, apart from each other
    const {bbox: {left, top, width, height}} = chart, room = 1.1 * letters(chart), [, last] = chart.series[0].idxs ?? [];
    const ends = shownRuns(chart).filter((k) => Number.isFinite(chart.data[k][last]))
      .map((k) => ({k, y: chart.valToPos(chart.data[k][last], 'y', true)})).sort((a, b) => a.y - b.y);
    ends.forEach((end, row) => end.y = Math.max(end.y, row ? ends[row - 1].y + room : top + room / 2));
    ends.reduceRight((floor, end) => (end.y = Math.min(end.y, floor)) - room, top + height - room / 2);
    ends.forEach(({k, y}) => {
      const {label} = chart.series[k], colour = chart.series[k].stroke(chart, k).slice(0, 7);
      write(chart, label, left + width - 3 * devicePixelRatio, y, colour, 'right');
    });
  };
  const reshape = (chart) => {
    const shape = shapeOf(chart);
    chart.root.dataset.shape = shape;
    if (shape === 'strips') drawStrips(chart);
    if (shape === 'band') drawBand(chart);
    if (shape === 'curves' && look.names && shownRuns(chart).length > 1) drawNames(chart);
    return shape;
  };
  // The curve of a wheel that is picked, or whose name is pointed at, is drawn once more over the others.
  const PALE = 0.2, picked = new WeakMap(), pointed = new WeakMap();  // chart -> number of its curve
  const notePicked = (chart) => {
    const clear = chart.series.flatMap((_, k) => isClear(chart, k) ? [k] : []);
    if (clear.length === 1 && chart.series.filter(isRun).length > 1) picked.set(chart, clear[0]);
  };
  const drawInFront = (chart) => {
    const k = pointed.get(chart) ?? picked.get(chart), curve = chart.series[k];
    if (!curve?.show || !curve.drawn) return;
    inPlot(chart, (ctx) => {
      ctx.lineWidth = curve.width * devicePixelRatio;
      ctx.translate(ctx.lineWidth % 2 / 2, ctx.lineWidth % 2 / 2);  // as uPlot does
      ctx.strokeStyle = curve.stroke(chart, k);
      ctx.stroke(curve.drawn);
    });
  };
  const pointAt = (chart, k) => {  // let a curve stand out, with its baseline, among pale ones; undefined: none
    pointed.set(chart, k);
    const kept = chart.series[k]?.label;
    chart.series.forEach((curve) => curve.alpha = k === undefined || curve.label === kept ? 1 : PALE);
    chart.redraw(false, false);
  };
  // The largest value of a curve during the motion is a dot, also where no point of the curve reaches it: the axis does.
  const peaks = {};  // [name, time, value] of each peak, by the unit of its chart
  const peaksOf = (chart) => {  // with the number of the curve, those in view
    if (chart.cursor.sync.key !== TIME) return [];
    const {min, max} = chart.series[0];  // of the points in view
    return (peaks[chart.axes[1].label] ?? []).flatMap(([name, time, value]) => {
      const k = chart.series.findIndex((curve) => isRun(curve) && curve.label === name);
      return k > 0 && chart.series[k].show && min <= time && time <= max ? [{k, time, value}] : [];
    });
  };
  const reachPeaks = (chart) => {
    const {range} = chart.scales.y;
    chart.scales.y.range = (it, low, high, key) => {
      const values = peaksOf(it).map(({value}) => value);
      return values.length ? range(it, Math.min(low, ...values), Math.max(high, ...values), key) : range(it, low, high, key);
    };
  };
  const drawPeaks = (chart) => {
    const {ctx} = chart, px = devicePixelRatio, marked = peaksOf(chart);
    const place = ({time, value}) => [chart.valToPos(time, 'x', true), chart.valToPos(value, 'y', true)];
    const paint = (colour, draw) => { ctx.fillStyle = colour; draw(); };
    chart.peaks = JSON.stringify(peaks[chart.axes[1].label]);
    ctx.save();
    marked.forEach((peak) => paint(chart.series[peak.k].stroke(chart, peak.k), () => {
      ctx.beginPath();
      ctx.arc(...place(peak), 2.5 * px, 0, 2 * Math.PI);
      ctx.fill();
    }));
    // The number of the largest that is not pale, beyond it, on a patch of the page's colour
    const clear = marked.filter(({k}) => isClear(chart, k));
    if (clear.length) {
      const most = clear.reduce((a, b) => Math.abs(b.value) > Math.abs(a.value) ? b : a), [x, y] = place(most);
      const {left, top, width, height} = chart.bbox, beyond = y + (most.value < 0 ? 10 : -10) * px;
      const text = `${most.value.toFixed(most.value < 1000 ? 1 + more(chart) : 0)} ${chart.axes[1].label}`.replace('-', '−');
      ctx.font = `${letters(chart)}px system-ui, sans-serif`;
      [ctx.textAlign, ctx.textBaseline, ctx.lineJoin] = ['left', 'middle', 'round'];
      const at = [
        Math.min(x - 3 * px, left + width - ctx.measureText(text).width),
        Math.min(Math.max(beyond, top + 6 * px), top + height - 6 * px),
      ];
      [ctx.strokeStyle, ctx.lineWidth] = [getComputedStyle(document.body).backgroundColor, 3 * px];
      ctx.strokeText(text, ...at);
      paint(chart.axes[1].stroke(chart, 1), () => ctx.fillText(text, ...at));
    }
    ctx.restore();
  };
  // A chart is made 0 px wide. If it gets its width while it is being drawn, it may overlook the axis of time, which then
  // has neither numbers nor lines until the width changes: it is told again.
  const layOut = (chart) => {
    const {width, height} = chart;
    if (width > 0 && !chart.axes[0]._values) chart.setSize({width, height});
  };
  const meet = (chart) => {
    met.add(chart);
    const around = chart.root.closest('.uplot-container')?.parentElement;
    around?.setAttribute('data-trackride', 'chart');
    around?.parentElement?.setAttribute('data-trackride', 'charts');  // plots.css puts them side by side there
    chart.root.classList.add(chart.cursor.sync.key);
    chart.root.querySelector('.u-title').title =
      'Drag across the plot to zoom in (or Ctrl and the wheel), double-click to see all; click to go to a time';
    const legend = chart.root.querySelector('.u-legend');
    legend.title = 'Point at a name to see its curve in front, click it to hide the curve, with Ctrl all others';
    legend.querySelectorAll('.u-series').forEach((name, k) => {
      if (!isRun(chart.series[k])) return;
      name.addEventListener('mouseenter', () => pointAt(chart, k));
      name.addEventListener('mouseleave', () => pointAt(chart));
      const heading = name.querySelector('th');
      [heading.tabIndex, heading.ariaLabel] = [0, `${chart.series[k].label}: show or hide`];
      heading.setAttribute('role', 'button');
      heading.addEventListener('keydown', (event) => {
        if (event.key !== 'Enter') return;
        event.stopPropagation();
        heading.click();
      });
    });
    chart.series.forEach((_, k) => thicken(chart, k));
    notePicked(chart);
    reachPeaks(chart);
    chart.series.forEach((curve) => curve.value = valueOf);
    hide(chart);
    chart.redraw();  // with lines as thick as they are to be, also where no other run comes
    (chart.hooks.setSeries ??= []).push((_, k, change) => {
      if (k === null || change.show === undefined || !isRun(chart.series[k])) return;
      const [runs, gone] = kin(chart);
      runs.forEach(({label, show}) => show ? gone.delete(label) : gone.add(label));
      queueMicrotask(() => hide(chart));
    });
    (chart.hooks.draw ??= []).push(() => {
      const [first, last] = ends(chart), {min, max} = chart.scales.x, shared = groupOf(chart);
      const drawn = last > first && max > min && inView.has(chart);
      const shape = reshape(chart);
      if (shape === 'curves') drawInFront(chart);
      if (shape === 'curves') drawPeaks(chart);
      if (drawn) shared.zoom = [(min - first) / (last - first), (max - first) / (last - first)];
      point(chart);
      frame(chart);
      drawMaps();
      requestAnimationFrame(() => read(chart));
      queueMicrotask(() => layOut(chart));
    });
    chart.over.addEventListener('mouseleave', () => setTimeout(window.trackridePlots, 0));
    useMouse(chart);
    useKeys(chart);
  };
  let clicks = 0;
  const goTo = (time) => trackrideInTurn(() => trackrideTell('at', JSON.stringify([Math.max(time, 0), ++clicks])));
  // By keyboard: a plot is reached by Tab; ← → move its cursor by a pixel (with Shift ten), to where the curve has another
  // point at least, Home and End to its ends, Enter puts the time there, Esc leaves it. Its values are told to who listens
  const said = Object.assign(document.createElement('div'), {className: 'trackride-said', ariaLive: 'polite'});
  document.body.append(said);
  const useKeys = (chart) => {
    const {over} = chart, timed = chart.cursor.sync.key === TIME, unit = chart.axes[1].label;
    over.tabIndex = 0;
    over.setAttribute('role', 'application');
    const title = () => chart.root.querySelector('.u-title').textContent;
    const keys = `left and right arrow keys move the cursor${timed ? ', Enter goes to its time' : ''}, Escape leaves`;
    let idx = null;
    const show = () => {
      const x = chart.data[0], at = [chart.valToPos(x[idx], 'x'), over.clientHeight / 2];
      chart.setCursor({left: Math.min(Math.max(at[0], 0), over.clientWidth - 0.01), top: at[1]});
      const values = shownRuns(chart).map((k) => `${chart.series[k].label} ${valueOf(chart, chart.data[k][idx], k, idx)}`);
      said.textContent = `${x[idx].toFixed(2)} ${timed ? 's' : 'Hz'}: ${values.join(', ')} ${unit}`;
    };
    const leave = () => {
      if (idx === null) return;
      idx = null;
      chart.setCursor({left: -10, top: -10});
      setTimeout(window.trackridePlots, 0);  // the values at the time again
    };
    over.addEventListener('focus', () => {
      over.ariaLabel = `${title()}: plot; ${keys}`;
      if (!over.matches(':focus-visible')) return;  // by the mouse
      const now = timed ? groupOf(chart).marks[0]?.[0] ?? 0 : chart.scales.x.min;
      idx = chart.valToIdx(Math.min(Math.max(now, chart.scales.x.min), chart.scales.x.max));
      show();
    });
    over.addEventListener('blur', leave);
    over.addEventListener('keydown', (event) => {
      const {key, shiftKey} = event, step = {ArrowLeft: -1, ArrowRight: 1}[key];
      if (idx === null || !step && !['Home', 'End', 'Enter', 'Escape'].includes(key)) return;
      event.preventDefault();
      event.stopPropagation();  // elsewhere they step through the run
      if (key === 'Escape') return over.blur();
      const {min, max} = chart.scales.x, [first, last] = [chart.valToIdx(min), chart.valToIdx(max)];
      const x = chart.data[0];
      if (key === 'Enter') return timed ? goTo(x[idx]) : undefined;
      const there = x[idx] + step * (shiftKey ? 10 : 1) * (max - min) / over.clientWidth;
      const next = step > 0 ? Math.max(chart.valToIdx(there), idx + 1) : Math.min(chart.valToIdx(there), idx - 1);
      idx = step ? Math.min(Math.max(next, first), last) : key === 'Home' ? first : last;
      show();
    });
  };
  // Where the mouse is, in figures; a click moves the time there; the wheel zooms, in plots beside the view with Ctrl, so
  // that the tab can be scrolled
  const useMouse = (chart) => {
    const {over} = chart, timed = chart.cursor.sync.key === TIME, at = document.createElement('span');
    at.className = 'trackride-at';
    over.append(at);
    (chart.hooks.setCursor ??= []).push(() => {
      const {left} = chart.cursor;
      at.hidden = !(left >= 0);
      if (at.hidden) return;
      at.textContent = `${chart.posToVal(left, 'x').toFixed(2)} ${timed ? 's' : 'Hz'}`;
      at.style.left = `${Math.min(Math.max(left, 24), over.clientWidth - 24)}px`;
    });
    let pressed = null;
    over.addEventListener('mousedown', (event) => pressed = event.clientX);
    over.addEventListener('click', (event) => {
      if (!timed || event.detail > 1 || Math.abs(event.clientX - (pressed ?? event.clientX)) > 3) return;
      goTo(chart.posToVal(event.clientX - over.getBoundingClientRect().left, 'x'));
    });
    over.addEventListener('wheel', (event) => {
      if (!event.ctrlKey && document.documentElement.dataset.plots !== 'large') return;
      event.preventDefault();
      const [first, last] = ends(chart), {min, max} = chart.scales.x, key = chart.cursor.sync.key;
      const on = chart.posToVal(event.clientX - over.getBoundingClientRect().left, 'x'), by = event.deltaY > 0 ? 1.25 : 0.8;
      const span = Math.min(Math.max(by * (max - min), (last - first) / 500), last - first);
      const low = Math.min(Math.max(on - (on - min) / (max - min) * span, first), last - span);
      zoomAll([(low - first) / (last - first), (low + span - first) / (last - first)], key);
    }, {passive: false});
  };
  customElements.define('trackride-tools', class extends HTMLElement {
    connectedCallback() {
      this.addEventListener('click', ({target}) => {
        const {shape, act} = target.closest('button')?.dataset ?? {};
        if (act === 'large')  // its key (app/panels/shortcuts.py)
          document.body.dispatchEvent(new KeyboardEvent('keydown', {key: 'l', code: 'KeyL', bubbles: true}));
        if (act === 'names') look.names = !look.names;
        if (shape) look.shape = shape;
        if (!shape && act !== 'names') return;
        sessionStorage.setItem('trackride-plots', JSON.stringify(look));
        document.querySelectorAll('trackride-tools').forEach((tools) => tools.show());
        charts().filter((chart) => met.has(chart) && seen(chart)).forEach((chart) => chart.redraw());
      });
      this.show();
    }

    show() {
      this.querySelectorAll('button[data-shape]').forEach((button) => {
        button.ariaPressed = String(button.dataset.shape === look.shape);
      });
      const names = this.querySelector('button[data-act="names"]');
      if (names) names.ariaPressed = String(look.names);
    }
  });
  let now = -1;  // s, of the time cursor
  window.trackridePlots = () => {
    drawMaps();
    charts().filter(groupOf).forEach((chart) => {
      if (!seen(chart)) return inView.delete(chart);
      if (!met.has(chart)) meet(chart);
      if (!inView.has(chart)) zoom(chart);
      layOut(chart);
      inView.add(chart);
      point(chart);
      frame(chart);
      read(chart);
    });
  };

  const steps = (low, high) => {  // of an axis: five or a few more
    const power = 10 ** Math.floor(Math.log10((high - low) / 5));
    const step = power * [5, 2, 1].find((factor) => factor * power <= (high - low) / 5 * (1 + 1e-9));
    const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
    return Array.from({length: last - first + 1}, (_, k) => +((first + k) * step).toFixed(9));
  };
  const drawMaps = () => document.querySelectorAll('trackride-map').forEach((map) => map.draw());
  const zoomAll = (range, key = TIME) => {
    group(key).zoom = range;
    charts().filter((chart) => chart.cursor.sync?.key === key && inView.has(chart)).forEach(zoom);
    drawMaps();
  };
  customElements.define('trackride-map', class extends HTMLElement {
    connectedCallback() {
      [this.start, this.span] = [Number(this.getAttribute('start')), Number(this.getAttribute('span'))];
      let from = null, field;  // of a stretch that is being marked: where it began, 0…1 of the field
      const at = (event) => {
        const box = field.getBoundingClientRect();
        return Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
      };
      this.addEventListener('pointerdown', (event) => {
        field = event.target.closest('.field');
        if (!field || event.button) return;
        from = at(event);
        field.setPointerCapture(event.pointerId);
        event.preventDefault();
      });
      this.addEventListener('pointermove', (event) => {
        if (from === null) return;
        const [low, high] = [from, at(event)].sort((a, b) => a - b);
        const mark = field.querySelector('b').style;
        [mark.left, mark.width] = [`${100 * low}%`, `${100 * (high - low)}%`];
      });
      this.addEventListener('pointerup', (event) => {
        if (from === null) return;
        const [low, high] = [from, at(event)].sort((a, b) => a - b), [first, last] = group(TIME).zoom;
        from = null;
        field.querySelector('b').style.width = 0;
        if (high - low > 0.01) zoomAll([first + low * (last - first), first + high * (last - first)]);
      });
      this.addEventListener('dblclick', () => zoomAll([0, 1]));
      this.draw();
    }

    draw() {
      const [from, to] = group(TIME).zoom, {start, span} = this;
      const place = (time) => 100 * ((time - start) / span - from) / (to - from);  // % of the field
      if (this.now !== now || this.zoom !== `${from} ${to}`) {
        this.now = now;
        this.querySelectorAll('.field i').forEach((line) => line.style.left = `${place(now)}%`);
      }
      if (this.zoom === `${from} ${to}`) return;
      this.zoom = `${from} ${to}`;
      this.classList.toggle('near', to - from < 0.3);
      this.querySelectorAll('img').forEach(({style}) => {
        [style.width, style.marginLeft] = [`${100 / (to - from)}%`, `${-100 * from / (to - from)}%`];
      });
      const times = steps(start + from * span, start + to * span).map((time) => {
        const label = Object.assign(document.createElement('span'), {textContent: time});
        label.style.left = `${place(time)}%`;
        return label;
      });
      this.querySelectorAll('.times').forEach((axis) => axis.replaceChildren(...times.map((t) => t.cloneNode(true))));
    }
  });
  customElements.define('trackride-marks', class extends HTMLElement {
    connectedCallback() {
      const marks = JSON.parse(this.getAttribute('at'));
      group(this.getAttribute('for')).marks = marks;
      if (marks[0]?.[1] === '') now = marks[0][0];
      window.trackridePlots();
    }
  });

  customElements.define('trackride-peaks', class extends HTMLElement {
    connectedCallback() {
      Object.assign(peaks, JSON.parse(this.getAttribute('at')));
      requestAnimationFrame(() => charts().forEach((chart) => {  // those whose curves came before
        if (inView.has(chart) && chart.peaks !== JSON.stringify(peaks[chart.axes[1].label])) chart.redraw();
      }));
    }
  });

  customElements.define('trackride-span', class extends HTMLElement {
    connectedCallback() {
      group(TIME).window = JSON.parse(this.getAttribute('at'));
      window.trackridePlots();
    }
  });

  let front = '';  // names of the tabs that are seen
  const tell = () => {  // in the hidden box beside the page's keys, which is not there while that panel is put away
    const box = document.querySelector('[data-trackride="page"] + div + div input');
    if (!box || box.value === front) return;
    (window.trackrideInTurn ?? setTimeout)(() => {
      Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(box, front);  // past React's own
      box.dispatchEvent(new Event('input', {bubbles: true}));
    });
  };
  const tabs = new ResizeObserver(() => {  // a tab behind is 0 px wide
    const seen = [...document.querySelectorAll('trackride-tab')].filter((tab) => tab.offsetWidth);
    front = seen.map((tab) => tab.getAttribute('name')).join();
    tell();
  });
  customElements.define('trackride-tab', class extends HTMLElement {
    connectedCallback() { tabs.observe(this); }
  });
  setInterval(() => { window.trackridePlots(); tell(); }, 250);
}
