/**
 * Charts of app/report/page.html, without a browser: points are at the positions given by the ticks of their axes, and values
 * without a position are left out and counted.
 */
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";

// ---- the script of the page ----

class Element {
    constructor(name) {
        Object.assign(this, { name, attributes: {}, children: [] });
    }
    setAttribute(name, value) {
        this.attributes[name] = String(value);
    }
    append(...children) {
        this.children.push(...children.map((child) => (child instanceof Element ? child : String(child))));
    }
    get text() {
        return this.children.map((child) => child.text ?? child).join("");
    }
    /** All elements inside with this name, and with this word in their class. */
    all(name, word = "") {
        return this.children.filter((child) => child instanceof Element).flatMap((child) => {
            const fits = child.name === name && ` ${child.attributes.class ?? ""} `.includes(word && ` ${word} `);
            return [...(fits ? [child] : []), ...child.all(name, word)];
        });
    }
}

const document = {
    createElement: (name) => new Element(name),
    createElementNS: (_, name) => new Element(name),
    getElementById: (id) => (id === "shapes" ? { namespaceURI: "" } : null), // so there are no charts on it
    querySelector: () => new Element("nav"),
    querySelectorAll: () => [],
};
const page = readFileSync(new URL("../../app/report/page.html", import.meta.url), "utf8");
const script = /<script>\n([^]*)<\/script>/.exec(page)[1];
const names = "linearAxis, logAxis, hasPlace, layOut, placeNames, drawPlot, drawBars, short";
const { linearAxis, logAxis, hasPlace, layOut, placeNames, drawPlot, drawBars, short } =
    new Function("document", `${script}; return { ${names} };`)(document);

/** A chart of one series, of points [x, y, more]. */
const chartOf = (points, more = {}) => ({
    title: "A chart", x: "strands", y: "ms", xLog: false, yLog: false, bars: false,
    series: [{ name: "ours", joined: true, points: points.map(([x, y, extra]) => ({ x, y, ...extra })) }], ...more,
});

function drawn(chart) {
    const root = new Element("figure");
    root.append(...(chart.bars ? drawBars(chart) : drawPlot(chart)));
    return root;
}

const near = (value, expected, within) => assert.ok(Math.abs(value - expected) <= within, `${value} is not ${expected}`);
const number = (element, name) => Number(element.attributes[name]);
const marks = (root) => root.all("g", "point").flatMap((g) => g.all("use"));

/** Coordinate of the tick with a label. */
function tickAt(root, axis, label) {
    const tick = root.all("text", axis).find((text) => text.text === label);
    assert.ok(tick, `there is a tick ${label} among ${root.all("text", axis).map((text) => text.text)}`);
    return axis === "x" ? number(tick, "x") : number(tick, "y") - 4; // a label of the y axis is slightly below its line
}

// ---- positions ----

test("points of linear axes stand between their ticks", () => {
    const points = [[-4, 0.01], [2.5, 0.0375], [10, 0.05]], root = drawn(chartOf(points));
    const [left, right] = ["0", "10"].map((label) => tickAt(root, "x", label));
    const [bottom, top] = ["0.01", "0.05"].map((label) => tickAt(root, "y", label));
    assert.ok(right > left + 100 && bottom > top + 100);
    marks(root).forEach((mark, i) => {
        near(number(mark, "x"), left + ((right - left) * points[i][0]) / 10, 0.03);
        near(number(mark, "y"), bottom + ((top - bottom) * (points[i][1] - 0.01)) / 0.04, 0.03);
    });
    assert.equal(marks(root).length, 3);
});

test("points of logarithmic axes stand between their ticks", () => {
    const points = [[100, 0.02], [3000, 1], [50000, 314]], root = drawn(chartOf(points, { xLog: true, yLog: true }));
    const [left, right] = ["100", "10\u2009000"].map((label) => tickAt(root, "x", label));
    const [bottom, top] = ["0.1", "100"].map((label) => tickAt(root, "y", label));
    marks(root).forEach((mark, i) => {
        near(number(mark, "x"), left + ((right - left) * Math.log10(points[i][0] / 100)) / 2, 0.03);
        near(number(mark, "y"), bottom + ((top - bottom) * Math.log10(points[i][1] / 0.1)) / 3, 0.03);
    });
    assert.equal(marks(root).length, 3);
});

test("a line goes through its points", () => {
    const root = drawn(chartOf([[1, 3], [2, 5], [3, 4]]));
    const expected = marks(root).map((mark, i) => `${i === 0 ? "M" : "L"}${mark.attributes.x} ${mark.attributes.y}`).join("");
    assert.deepEqual(root.all("path", "line").map((line) => line.attributes.d), [expected, "M0 8H30"]); // the other is of the key
});

test("what has no place is left out, counted and not bridged", () => {
    const points = [[1, 1], [2, null], [3, 2], [4, 0], [5, 3], [null, 1]];
    const root = drawn(chartOf(points, { yLog: true }));
    assert.equal(marks(root).length, 3);
    assert.match(root.text, /3 points have no place on these axes, for want of a finite value above 0\./);
    assert.match(root.all("path", "line")[0].attributes.d, /^M[^ML]+M[^ML]+M[^ML]+$/);
    assert.equal(marks(drawn(chartOf(points))).length, 4); // a linear axis can show 0
});

test("charts of nothing say so", () => {
    const withoutSeries = chartOf([], { series: [] }), bars = chartOf([[0, null]], { bars: true });
    for (const chart of [chartOf([]), chartOf([[null, 1], [1, null]]), withoutSeries, bars]) {
        const root = drawn(chart);
        assert.match(root.text, /There is nothing to draw\./);
        assert.deepEqual(root.all("svg"), []);
    }
});

test("one point of any size stands inside", () => {
    for (const value of [0, 1, -1, 7.3, 1e-12, -3e-99, 1e99, 123456.789, 5e-324, 1e-100]) {
        for (const isLog of [false, true].filter((log) => hasPlace(log, value))) {
            const [mark] = marks(drawn(chartOf([[value, value]], { xLog: isLog, yLog: isLog })));
            const x = number(mark, "x"), y = number(mark, "y");
            assert.ok(x >= 56 && x <= 544 && y >= 14 && y <= 310, `${value}`);
        }
    }
});

// ---- axes ----

test("linear ticks are round, few, and hold all values", () => {
    const ends = [[0, 1], [0.3, 0.7], [-5, 17], [1e-9, 7e-9], [990, 1000], [-3e7, -1e7], [0.1, 0.30000001], [-1e100, 1e100],
        [1, 1.0000001]];
    for (const [least, most] of ends) {
        const { lower, upper, ticks } = linearAxis(least, most), step = (upper - lower) / (ticks.length - 1);
        assert.ok(lower <= least + 1e-6 * step && upper >= most - 1e-6 * step);
        assert.ok(ticks.length >= 3 && ticks.length <= 8 && ticks.every((tick) => tick.label));
        assert.match(step.toExponential(5), /^[125]\.00000e/);
        ticks.forEach((tick, i) => near(tick.value, lower + i * step, 1e-6 * step));
    }
});

test("logarithmic ticks are few, rise, and hold all values", () => {
    const ends = [[1, 10], [0.3, 0.7], [2.1, 2.9], [1e-9, 7e-3], [990, 1000], [1e-100, 1e100], [100, 50000], [1e-4, 1e6],
        [0.001, 0.0010001]];
    for (const [least, most] of ends) {
        const { lower, upper, ticks } = logAxis(least, most), labels = ticks.filter((tick) => tick.label).length;
        assert.ok(lower <= least * (1 + 1e-8) && upper >= most * (1 - 1e-8) && lower > 0.1 * least && upper < 10 * most);
        assert.match(`${lower.toExponential()} ${upper.toExponential()}`, /^[125]e\S+ [125]e/);
        assert.ok(labels >= 2 && labels <= 10);
        assert.ok(ticks.every((tick, i) => i === 0 || tick.value > ticks[i - 1].value));
    }
});

test("ticks are written exactly", () => {
    const labels = (axis) => axis.ticks.map((tick) => tick.label);
    assert.deepEqual(labels(linearAxis(0, 0.3)), ["0", "0.1", "0.2", "0.3"]);
    assert.equal(labels(linearAxis(-200000, 0))[0], "−200\u2009000");
    assert.equal(labels(logAxis(1e-9, 1e-3))[0], "10⁻⁹");
    assert.deepEqual(labels(linearAxis(-1.5e-8, 1e-8)).slice(0, 2), ["−1.5·10⁻⁸", "−10⁻⁸"]);
    assert.deepEqual(labels(linearAxis(0, 3e12)).slice(1, 3), ["10¹²", "2·10¹²"]);
});

test("numbers have four digits, or all of a whole number", () => {
    assert.deepEqual([0, 0.0123456, 12.3456, 123456.7, -0.5, 1.23456e-7, 2.5e9, null].map(short),
        ["0", "0.01235", "12.35", "123\u2009457", "−0.5", "1.235·10⁻⁷", "2.5·10⁹", "-"]);
});

// ---- what stands out ----

test("marked points have a ring around them", () => {
    const root = drawn(chartOf([[1, 1], [2, 3, { marked: true }]])), rings = root.all("circle", "ring"), mark = marks(root)[1];
    assert.deepEqual(rings.map((ring) => [ring.attributes.cx, ring.attributes.cy]), [[mark.attributes.x, mark.attributes.y]]);
});

test("a tooltip has name, label and both values with their units", () => {
    const root = drawn(chartOf([[2000, 0.0123456, { label: "10 + tethers" }]]));
    assert.equal(root.all("title")[0].text, "ours: 10 + tethers\n2000 · strands\n0.01235 · ms");
});

test("names beside points cover neither points nor names", () => {
    const points = Array.from({ length: 40 }, (_, i) => [(i * 37) % 41, (i * i * 13) % 43, { marked: true, label: `name ${i}` }]);
    const chart = chartOf(points), layout = layOut(chart), names = placeNames(chart, layout);
    assert.ok(names.length >= 3);
    names.forEach((name, i) => {
        const covers = (x, y) => x > name.left && x < name.right && y > name.top && y < name.bottom;
        assert.ok(!layout.drawn.some((p) => covers(layout.xOf(p.x), layout.yOf(p.y))), name.text);
        const isApart = (b) => b.right <= name.left || b.left >= name.right || b.bottom <= name.top || b.top >= name.bottom;
        assert.ok(names.slice(0, i).every(isApart), name.text);
    });
});

test("sixteen series differ in colour or shape", () => {
    const series = Array.from({ length: 16 }, (_, i) => ({ name: `series ${i}`, joined: false, points: [{ x: i, y: i }] }));
    const root = drawn(chartOf([], { series }));
    const signs = root.all("g", "point").map((g) => `${g.attributes.class} ${g.all("use")[0].attributes.href}`);
    assert.equal(new Set(signs.map((sign) => sign.replace(" dashed", ""))).size, 16);
    assert.deepEqual(root.all("li").map((li) => li.text), series.map((s) => s.name));
});

// ---- bars ----

const barsOf = (values, more = {}) => chartOf([], {
    bars: true, series: [values, values.slice(0, 1)].map((ys, s) => ({
        name: `${s}`, joined: false, points: ys.map((y, x) => ({ x, y, label: `effect ${x}` })),
    })), ...more,
});
/** In percent; those of the key are not. */
const lengths = (root) => root.all("rect", "bar").map((bar) => bar.attributes.width).filter((width) => width.endsWith("%")).map(parseFloat);

test("bars are as long as their values", () => {
    const root = drawn(barsOf([2, 8, null, 0.5]));
    assert.deepEqual(lengths(root), [25, 25, 100, 6.25]); // the second one is of the other series
    const rows = root.all("tr").map((row) => row.text);
    assert.ok(rows.includes("effect 2-"), "an unknown value has a line and no bar");
    assert.equal(root.all("th").find((th) => th.text === "effect 0").attributes.rowspan, "2");
    assert.deepEqual(lengths(drawn(barsOf([-1, 3]))), [25, 25, 75]);
});

test("logarithmic bars begin a decade below the smallest", () => {
    assert.deepEqual(lengths(drawn(barsOf([1, 1000, 10], { yLog: true }))), [25, 25, 100, 50]);
});
