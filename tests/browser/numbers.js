// Numbers of the page that differ from the data at their pointers.
const data = JSON.parse(document.getElementById('data').textContent);
const at = pointer => pointer.split('/').slice(1).reduce(
    (value, key) => value[key.replace(/~1/g, '/').replace(/~0/g, '~')], data);
let count = 0, empty = 0, wrong = [];
for (const element of document.querySelectorAll('[data-at]')) {
  const value = at(element.dataset.at);
  if (element.tagName === 'SPAN') {
    if (value !== null || element.textContent !== '\u2013') wrong.push(element.dataset.at);
    ++empty;
    continue;
  }
  ++count;
  const text = element.textContent.replace(/[\u202f ]/g, '');
  const shown = Number(text.replace('%', '')), scale = text.endsWith('%') ? 100 : 1;
  const [digits, power] = text.replace('%', '').split('e');
  const places = (digits.split('.')[1] || '').length;
  const unit = Math.pow(10, (power ? Number(power) : 0) - places);
  const off = Math.abs(shown - value * scale);
  if (Number(element.value) !== value || !(off <= 0.5001 * unit)) {
    wrong.push([element.dataset.at, element.value, text, value]);
  }
}
return {count, empty, wrong: wrong.slice(0, 5)};
