// Elements: no framework, no markup out of text, so that a name from a file is never read as markup.

const SVG = 'http://www.w3.org/2000/svg';

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === undefined || value === null || value === false) continue;
    if (name === 'on') {
      for (const [event, act] of Object.entries(value)) element.addEventListener(event, act);
    } else if (name === 'style') {
      for (const [property, setting] of Object.entries(value)) element.style.setProperty(property, setting);
    } else if (name in element && typeof value === 'boolean') {
      element[name] = value;
    } else {
      element.setAttribute(name, value === true ? '' : String(value));
    }
  }
  for (const child of children.flat(Infinity)) {
    if (child === undefined || child === null || child === false) continue;
    element.append(child instanceof Node ? child : String(child));
  }
  return element;
}

/** An HTML element. `attributes.on` has event handlers, `attributes.style` properties of style. */
export function h(tag, attributes, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** An SVG element. */
export function svg(tag, attributes, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

/** Symbols with subscripts: `k_φ` becomes k with a lower φ, in HTML. */
export function symbol(text) {
  const [base, sub] = text.split('_');
  return h('span', { class: 'symbol' }, h('i', {}, base), sub ? h('sub', {}, sub) : null);
}

/** Symbols with subscripts in SVG. */
export function svgSymbol(text) {
  const [base, sub] = text.split('_');
  const parts = [svg('tspan', { 'font-style': 'italic' }, base)];
  if (sub) {
    parts.push(svg('tspan', { dy: '0.3em', 'font-size': '0.75em' }, sub));
    parts.push(svg('tspan', { dy: '-0.225em' }, '\u200b'));
  }
  return parts;
}

/** Offers a text as a file. */
export function download(name, type, text) {
  const address = URL.createObjectURL(new Blob([text], { type }));
  const link = h('a', { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}
