// Leads to what is wrong in a configuration that is edited as text: to the first line with a fault at once, to others by
// a click on what is said of them. `this` is the picture that runs this script, beside the list of faults.
const list = this.parentElement.querySelector('.trackride-faults');
const show = (line) => {
  const area = list.closest('.mantine-Modal-content')?.querySelector('textarea:not([aria-hidden])');
  if (!area) return;
  const lines = area.value.split('\n');
  const start = lines.slice(0, line - 1).reduce((sum, text) => sum + text.length + 1, 0);
  area.focus();
  area.setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
  area.scrollTop = (line - 1) * parseFloat(getComputedStyle(area).lineHeight) - area.clientHeight / 3;
};
const faults = [...list.querySelectorAll('[data-line]')];
for (const fault of faults) fault.onclick = () => show(Number(fault.dataset.line));
// After the window, which gives the keys to its first box, has opened
if (faults.length) setTimeout(show, 300, Number(faults[0].dataset.line));
