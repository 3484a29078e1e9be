// What each plot holds, which texts collide, and what lies outside.
const overlap = (a, b) => a.left < b.right - 1 && b.left < a.right - 1
                       && a.top < b.bottom - 1 && b.top < a.bottom - 1;
const data = JSON.parse(document.getElementById('data').textContent);
const at = pointer => pointer.split('/').slice(1).reduce((value, key) => value[key], data);
// How far the height of any mark is from that which its datum has between the highest and lowest;
// along x in plots without a height of their own. In pixels; marks may be moved sideways.
const far = (figure, marks) => {
  const fields = figure.dataset.fields.split(' '), field = fields[fields.length - 1];
  const along = fields.length > 1 ? b => (b.top + b.bottom) / 2 : b => (b.left + b.right) / 2;
  if (figure.dataset.fields === '') return 0;
  const places = marks.map(m => { const d = at(m.dataset.mark);
    return [Math.log10(typeof d === 'number' ? d : d[field]), along(m.getBoundingClientRect())]; });
  places.sort((a, b) => a[0] - b[0]);
  const [x0, y0] = places[0], [x1, y1] = places[places.length - 1];
  const slope = x1 > x0 ? (y1 - y0) / (x1 - x0) : 0;
  return Math.max(...places.map(([x, y]) => Math.abs(y - y0 - slope * (x - x0))));
};
return [...document.querySelectorAll('figure[data-plot]')].map(figure => {
  const svg = figure.querySelector('svg'), frame = svg.getBoundingClientRect();
  const marks = [...svg.querySelectorAll('.mark')];
  const texts = [...svg.querySelectorAll('text')].map(t => [t.textContent, t.getBoundingClientRect()]);
  const colliding = [], outside = [];
  texts.forEach(([name, box], i) => {
    if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1
        || box.bottom > frame.bottom + 1) outside.push(name);
    texts.slice(i + 1).forEach(([other, b]) => { if (overlap(box, b)) colliding.push([name, other]); });
  });
  const away = marks.filter(m => { const b = m.getBoundingClientRect();
    return b.left < frame.left || b.right > frame.right || b.top < frame.top || b.bottom > frame.bottom; });
  return {name: figure.dataset.plot, wanted: Number(figure.dataset.marks), marks: marks.length,
          titles: marks.filter(m => m.querySelector('title')).length,
          legend: svg.querySelectorAll('.legend .text').length,
          labels: [...svg.querySelectorAll('.axis > .text')].map(l => l.textContent.trim()),
          ticks: svg.querySelectorAll('.xtick text, .ytick text').length,
          size: [frame.width, frame.height], smallest: Math.min(...texts.map(([, b]) => b.height)),
          away_from_data: far(figure, marks), colliding, outside, away: away.length};
});
