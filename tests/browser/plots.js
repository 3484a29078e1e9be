// What each plot holds, which texts collide, and what lies outside.
const overlap = (a, b) => a.left < b.right - 1 && b.left < a.right - 1
                       && a.top < b.bottom - 1 && b.top < a.bottom - 1;
return [...document.querySelectorAll('figure[data-plot]')].map(figure => {
  const svg = figure.querySelector('.scroll > svg'), frame = svg.getBoundingClientRect();
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
          titles: svg.querySelectorAll('g > title, rect > title').length,
          legend: figure.querySelectorAll('.legend li').length,
          labels: [...svg.querySelectorAll('.label')].map(l => l.textContent),
          ticks: svg.querySelectorAll('.tick').length, size: [frame.width, frame.height],
          colliding, outside, away: away.length};
});
