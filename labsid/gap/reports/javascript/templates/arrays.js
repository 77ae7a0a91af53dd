// The functions of numpy that simulations use. A vector is a Float64Array; a matrix has its rows one after another and
// the number of its columns as `cols`. An operator takes two numbers, a number and an array, or two arrays of one size;
// a matrix of one row or one column, and a vector beside a matrix of as many columns, are repeated.
const np = (() => {
  const isArray = (x) => x instanceof Float64Array;
  const shaped = (x, cols) => { if (cols !== undefined) x.cols = cols; return x; };
  const array = (x, shape) => {
    const dimensions = shape ?? [];
    const made = isArray(x) && !shape ? x : Float64Array.from(x, Number);
    if (dimensions.length === 3) made.inner = dimensions[2];
    return dimensions.length > 1 ? shaped(made, made.length / dimensions[0]) : made;
  };
  const zeros = (shape) => (Array.isArray(shape)
    ? shaped(new Float64Array(shape[0] * shape[1]), shape[1]) : new Float64Array(shape));
  const full = (shape, value) => zeros(shape).fill(value);
  const each = (x, f) => {
    if (!isArray(x) && !Array.isArray(x)) return f(Number(x));
    const from = array(x);
    return shaped(from.map(f), from.cols);
  };
  const both = (f) => (a, b) => {
    if (typeof a === "number" && typeof b === "number") return f(a, b);
    if (!isArray(a) && Array.isArray(a)) a = array(a);
    if (!isArray(b) && Array.isArray(b)) b = array(b);
    if (!isArray(b)) return each(a, (x) => f(x, Number(b)));
    if (!isArray(a)) return each(b, (x) => f(Number(a), x));
    if (a.length !== b.length) throw new Error(`arrays of ${a.length} and ${b.length} numbers`);
    const made = new Float64Array(a.length);
    for (let i = 0; i < made.length; i++) made[i] = f(a[i], b[i]);
    return shaped(made, a.cols ?? b.cols);
  };
  const compare = (f) => (a, b) => (isArray(a) || isArray(b) ? both((x, y) => Number(f(x, y)))(a, b) : f(a, b));
  const shape = (x) => (x.cols === undefined ? [x.length] : [x.length / x.cols, x.cols]);
  const sum = (x) => Array.from(x).reduce((total, one) => total + one, 0);
  const values = (x, others) => (typeof x === "number" ? [x, ...others] : Array.from(x));
  const extreme = (f) => (x, ...others) => {
    const options = others.find((one) => typeof one === "object");
    const all = values(x, others.filter((one) => one !== options));
    return all.length ? all.reduce((a, b) => f(a, b)) : options.default;
  };
  // Indices of a dimension of `count` numbers that a number, a slice or a list selects.
  const slice = (start, stop) => ({ start, stop });
  const selected = (index, count) => {
    const within = (i, other) => Math.min(Math.max(i === undefined ? other : i < 0 ? i + count : i, 0), count);
    if (typeof index === "number") return [index < 0 ? index + count : index];
    if (Array.isArray(index)) return index;
    const start = within(index.start, 0);
    return Array.from({ length: Math.max(within(index.stop, count) - start, 0) }, (_, i) => start + i);
  };
  const take = (x, [first, second]) => {
    if (!isArray(x)) return typeof first === "number" ? x.at(first) : selected(first, x.length).map((i) => x[i]);
    if (x.cols === undefined) {
      if (typeof first === "number") return x.at(first);
      if (second === null) return shaped(x.slice(), 1);
      const { start, stop } = first;
      return x.slice(start, stop);
    }
    const [rows, cols] = shape(x);
    const down = selected(first, rows);
    const across = selected(second ?? slice(), cols);
    if (typeof first === "number" && typeof second === "number") return x[down[0] * cols + across[0]];
    const made = new Float64Array(down.length * across.length);
    let at = 0;
    for (const i of down) for (const j of across) made[at++] = x[i * cols + j];
    return typeof first === "number" || typeof second === "number" ? made : shaped(made, across.length);
  };
  const put = (x, [first, second], value) => {
    const cols = x.cols ?? 1;
    const across = x.cols === undefined ? [0] : selected(second ?? slice(), cols);
    let at = 0;
    for (const i of selected(first, x.length / cols)) {
      for (const j of across) x[i * cols + j] = typeof value === "number" ? value : value[at++];
    }
  };
  const column_stack = (parts) => {
    const arrays = parts.map((one) => array(one));
    const widths = arrays.map((one) => one.cols ?? 1);
    const cols = widths.reduce((a, b) => a + b);
    const rows = arrays[0].length / widths[0];
    const made = zeros([rows, cols]);
    let left = 0;
    arrays.forEach((one, part) => {
      for (let i = 0; i < rows; i++) for (let j = 0; j < widths[part]; j++) made[i * cols + left + j] = one[i * widths[part] + j];
      left += widths[part];
    });
    return made;
  };
  const matmul = (a, b) => {
    const left = array(a), right = array(b);
    const made = new Float64Array(left.length / right.length);
    for (let i = 0; i < left.length; i++) made[Math.floor(i / right.length)] += left[i] * right[i % right.length];
    return left.cols === undefined ? made[0] : made;
  };
  const transpose = (x) => {
    const [rows, cols] = shape(x);
    const made = zeros([cols, rows]);
    for (let i = 0; i < rows; i++) for (let j = 0; j < cols; j++) made[j * rows + i] = x[i * cols + j];
    return made;
  };
  const concatenate = (parts) => Float64Array.from(parts.flatMap((one) => Array.from(one)));
  const append = (x, last) => concatenate([x, typeof last === "number" ? [last] : last]);
  // Along the rows, after `append`.
  const diff = (x, options) => {
    const longer = append(x, options?.append ?? []);
    const cols = x.cols ?? 1;
    const made = new Float64Array(longer.length - cols);
    for (let i = 0; i < made.length; i++) made[i] = longer[i + cols] - longer[i];
    return shaped(made, x.cols);
  };
  const gradient = (x) => x.map((_, i) => {
    const after = Math.min(i + 1, x.length - 1), before = Math.max(i - 1, 0);
    return (x[after] - x[before]) / (after - before);
  });
  // Sum of `own[i]` times part i of an array of three dimensions.
  const tensordot = (own, parts) => {
    const made = new Float64Array(parts.length / own.length);
    for (let i = 0; i < parts.length; i++) made[i % made.length] += own[Math.floor(i / made.length)] * parts[i];
    return shaped(made, parts.inner);
  };
  const chebvander = (x, degree) => {
    const columns = [full(x.length, 1), x];
    while (columns.length <= degree) columns.push(x.map((one, i) => 2 * one * columns.at(-1)[i] - columns.at(-2)[i]));
    return column_stack(columns.slice(0, degree + 1));
  };
  const chebval = (x, own) => matmul(chebvander(x, own.length - 1), own);
  const clip = both((x, low) => Math.max(x, low)), capped = both((x, high) => Math.min(x, high));
  // The real root of cubic z^3 + k z = force that is nearest to force / k: by bisection, from the linear one outwards.
  const equilibrium = (force, k, cubic) => {
    const linear = force / k;
    const f = (z) => (cubic * z * z + k) * z - force;
    if (cubic === 0 || f(linear) === 0) return linear;
    const p = k / cubic, q = -force / cubic;
    const inside = (q / 2) ** 2 + (p / 3) ** 3;
    let roots = [];
    if (inside >= 0) {
      const u = Math.cbrt(-q / 2 - Math.sign(q || 1) * Math.sqrt(inside));
      roots = [u === 0 ? 0 : u - p / (3 * u)];
    } else {
      const size = 2 * Math.sqrt(-p / 3), angle = Math.acos(Math.min(Math.max((3 * q) / (p * size), -1), 1)) / 3;
      roots = [0, 1, 2].map((n) => size * Math.cos(angle - (2 * Math.PI * n) / 3));
    }
    const polished = roots.map((z) => { for (let i = 0; i < 3; i++) z -= f(z) / (3 * cubic * z * z + k || 1); return z; });
    return polished.reduce((a, b) => (Math.abs(b - linear) < Math.abs(a - linear) ? b : a));
  };
  return {
    array, zeros, full, shape, sum, slice, take, put, column_stack, matmul, transpose, concatenate, append, diff, gradient,
    tensordot, chebvander, chebval, equilibrium,
    empty: zeros, ones: (size) => full(size, 1), asarray: (x) => (typeof x === "number" ? x : array(x)),
    arange: (a, b) => Float64Array.from({ length: b === undefined ? a : b - a }, (_, i) => (b === undefined ? i : a + i)),
    eye: (size) => Array.from({ length: size }, (_, i) => Float64Array.from({ length: size }, (__, j) => Number(i === j))),
    add: both((x, y) => x + y), sub: both((x, y) => x - y), mul: both((x, y) => x * y), div: both((x, y) => x / y),
    pow: both((x, y) => x ** y), neg: (x) => each(x, (y) => -y),
    lt: compare((x, y) => x < y), le: compare((x, y) => x <= y), gt: compare((x, y) => x > y),
    ge: compare((x, y) => x >= y), eq: compare((x, y) => x === y), ne: compare((x, y) => x !== y),
    minimum: capped, maximum: clip, clip: (x, low, high) => capped(clip(x, low), high),
    min: extreme(Math.min), max: extreme(Math.max), mean: (x) => sum(x) / x.length,
    copy: (x) => shaped(x.slice(), x.cols), copysign: (x, sign) => (sign < 0 || Object.is(sign, -0) ? -Math.abs(x) : Math.abs(x)),
    exp: (x) => each(x, Math.exp), expm1: (x) => each(x, Math.expm1), log: (x) => each(x, Math.log),
    sqrt: (x) => each(x, Math.sqrt), cos: (x) => each(x, Math.cos), sin: (x) => each(x, Math.sin),
    tan: (x) => each(x, Math.tan), abs: (x) => each(x, Math.abs), sign: (x) => each(x, Math.sign),
    ceil: (x) => each(x, Math.ceil), floor: (x) => each(x, Math.floor),
    float: Number, int: (x) => Math.trunc(Number(x)), bool: (x) => (Array.isArray(x) ? x.length > 0 : Boolean(x)), len: (x) => x.length,
    range: (a, b) => Array.from({ length: Math.max(b === undefined ? a : b - a, 0) }, (_, i) => (b === undefined ? i : a + i)),
    zip: (a, b) => Array.from(a, (x, i) => [x, b[i]]), enumerate: (x, start = 0) => Array.from(x, (y, i) => [i + start, y]),
    list: (x) => [...x], tuple: (x) => [...x],
    get: (table, key, other = null) => (key in table ? table[key] : other),
    has: (holder, one) => (Array.isArray(holder) ? holder.includes(one) : one in holder),
  };
})();
