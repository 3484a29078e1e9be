// What is wider than the page, and how well its colours can be seen.
const page = document.documentElement;
const wide = [...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll, pre, svg')
  && e.getBoundingClientRect().right > page.clientWidth + 1).map(e => e.outerHTML.slice(0, 80));
const parse = text => text.match(/[\d.]+/g).slice(0, 3).map(Number);
const light = ([r, g, b]) => [r, g, b].map(v => v / 255).map(
  v => v <= 0.03928 ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4)).reduce(
  (sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
const paper = parse(getComputedStyle(page).backgroundColor);
const contrast = colour => { const [a, b] = [light(colour), light(paper)].sort((x, y) => y - x);
  return (a + 0.05) / (b + 0.05); };
const probe = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
document.body.append(probe);
const colours = [...Array(8).keys()].map(n => { const r = document.createElementNS(
  'http://www.w3.org/2000/svg', 'rect'); r.style.fill = `var(--c${n})`; probe.append(r);
  return parse(getComputedStyle(r).fill); });
return {paper, colours, scroll: page.scrollWidth, client: page.clientWidth, wide: wide.slice(0, 5),
        text: contrast(parse(getComputedStyle(document.body).color)),
        contrast: colours.map(contrast)};
