#include <algorithm>
#include <cmath>
#include <titop/emit/report/html.hpp>

namespace titop::report {
namespace {

/// Okabe and Ito's colours, which colour-blind readers can distinguish, darkened for lines on
/// white; every curve has a dash and a width of its own, too.
constexpr const char* kStyle = R"(
:root { color-scheme: light dark;
  --ink: #1f2933; --soft: #52606d; --rule: #d9e2ec; --fine: #edf1f5; --grid: #d3dbe3;
  --paper: #ffffff; --card: #f7f9fb; --accent: #0b5394; --good: #1b7a43; --bad: #b42318;
  --warn: #8a5a00; --warn-card: #fff6e0; --bar: #9fc3e6;
  --c1: #0b5394; --c2: #c44e00; --c3: #00795a; --c4: #95338c; --c5: #7a5c00; --c6: #444f8c; }
@media screen and (prefers-color-scheme: dark) { :root {
  --ink: #e4e9ee; --soft: #a6b3c0; --rule: #38434f; --fine: #242c34; --grid: #36414c;
  --paper: #14191e; --card: #1b2229; --accent: #7fb8ec; --good: #6fcf97; --bad: #ff8a80;
  --warn: #f2c14e; --warn-card: #2c2613; --bar: #2f5d88;
  --c1: #6db3f2; --c2: #ff9955; --c3: #35c9a0; --c4: #e08bd8; --c5: #e0c050; --c6: #a3aef0; }
  svg.drawing { filter: invert(0.91) hue-rotate(180deg); } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink);
  font: 15px/1.5 "Helvetica Neue", Helvetica, Arial, "Liberation Sans", "DejaVu Sans", sans-serif; }
main { max-width: 1180px; margin: 0 auto; padding: 28px 32px 64px; }
header { border-bottom: 3px solid var(--accent); padding-bottom: 14px; margin-bottom: 20px; }
h1 { font-size: 30px; line-height: 1.2; margin: 0 0 4px; overflow-wrap: anywhere; }
h2 { font-size: 21px; margin: 44px 0 10px; padding-bottom: 5px; border-bottom: 1px solid var(--rule); }
h3 { font-size: 16px; margin: 26px 0 8px; }
h4 { font-size: 14px; margin: 0 0 4px; font-weight: 600; overflow-wrap: anywhere; }
p { margin: 6px 0 10px; max-width: 90ch; }
.about, .note, figcaption { color: var(--soft); font-size: 13.5px; }
.about { margin: 0; }
nav { font-size: 13.5px; margin: 14px 0 0; display: flex; flex-wrap: wrap; gap: 4px 18px; }
a { color: var(--accent); }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(150px, 1fr)); gap: 12px;
  margin: 18px 0; }
.tile { background: var(--card); border: 1px solid var(--rule); border-radius: 8px; padding: 10px 14px; }
.tile b { display: block; white-space: nowrap; font-size: clamp(16px, 4.8vw, 24px); line-height: 1.25; font-variant-numeric: tabular-nums; }
.tile span { color: var(--soft); font-size: 13px; }
.verdicts { list-style: none; margin: 0 0 14px; padding: 0; }
.verdicts li { padding: 5px 0 5px 30px; position: relative; max-width: 100ch; }
.verdicts li::before { position: absolute; left: 4px; font-weight: 700; }
.verdicts .good::before { content: "✓"; color: var(--good); }
.verdicts .bad::before { content: "✗"; color: var(--bad); }
.verdicts .open::before { content: "?"; color: var(--warn); }
.verdicts .open, .verdicts .bad { background: var(--warn-card); border-radius: 6px; }
.table { overflow-x: auto; margin: 8px 0 14px; }
table { border-collapse: collapse; font-size: 14px; width: 100%; font-variant-numeric: tabular-nums; }
th { text-align: left; font-weight: 600; color: var(--soft); font-size: 13px; vertical-align: bottom;
  border-bottom: 1.5px solid var(--soft); padding: 4px 12px 4px 0; white-space: nowrap; }
td { padding: 4px 12px 4px 0; border-bottom: 1px solid var(--rule); vertical-align: top;
  overflow-wrap: anywhere; }
.n { text-align: right; white-space: nowrap; overflow-wrap: normal; }
.n + td, .n + th { padding-left: 16px; }
td.name:first-child { min-width: 11ch; }
.name { font-family: "DejaVu Sans Mono", "Liberation Mono", Menlo, Consolas, monospace; font-size: 12.5px; }
.fit { white-space: nowrap; }
.wide { min-width: 340px; }
span.good, td.good { color: var(--good); } span.bad, td.bad { color: var(--bad); }
.share { display: inline-block; margin: 0 14px 0 0; white-space: nowrap; }
.bar { display: inline-block; height: 9px; background: var(--bar); border-radius: 2px;
  margin-right: 5px; vertical-align: 0; min-width: 2px; print-color-adjust: exact;
  -webkit-print-color-adjust: exact; }
.columns { columns: 4 200px; font-size: 13px; margin: 4px 0; padding: 0; list-style: none; }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(430px, 100%), 1fr)); gap: 22px 28px; }
figure { margin: 0; min-width: 0; }
figure.plot { border: 1px solid var(--rule); border-radius: 8px; padding: 12px 14px 8px; }
figure.plot > svg { width: 100%; height: auto; display: block; }
.legend { list-style: none; display: flex; flex-wrap: wrap; gap: 2px 18px; margin: 0 0 6px; padding: 0;
  font-size: 12.5px; min-height: 20px; }
.legend li { display: flex; align-items: center; gap: 7px; overflow-wrap: anywhere; }
.sample { flex: none; }
figure.diagram { margin: 10px 0 24px; }
.canvas { overflow: auto; border: 1px solid var(--rule); border-radius: 8px; padding: 10px;
  text-align: center; }
svg.drawing { height: auto; max-width: 100%; max-height: 88vh; display: block; margin: auto; }
.scaled { display: none; }
figure.diagram:target svg.drawing { max-width: none; max-height: none; }
figure.diagram:target .full { display: none; } figure.diagram:target .scaled { display: inline; }
summary { cursor: pointer; color: var(--accent); font-size: 13.5px; }
figure.plot text { fill: var(--ink); }
.mark { stroke: var(--c2); stroke-width: 1.8; }
figure.plot .tick { font-size: 12px; fill: var(--soft); font-variant-numeric: tabular-nums; }
figure.plot .over { paint-order: stroke; stroke: var(--paper); stroke-width: 3px; }
.x-label, .y-label { font-size: 12.5px; }
.fine, .grid, .zero, .frame, .curve { fill: none; }
.fine { stroke: var(--fine); stroke-width: 0.7; } .grid { stroke: var(--grid); stroke-width: 0.8; }
.zero { stroke: var(--soft); stroke-width: 1; } .frame { stroke: var(--soft); stroke-width: 1.1; }
.curve { stroke-linejoin: round; stroke-linecap: butt; }
.c1 { stroke: var(--c1); stroke-width: 1.9; }
.c2 { stroke: var(--c2); stroke-width: 1.7; stroke-dasharray: 8 4; }
.c3 { stroke: var(--c3); stroke-width: 1.9; stroke-dasharray: 2 2.5; }
.c4 { stroke: var(--c4); stroke-width: 1.5; stroke-dasharray: 11 3 2 3; }
.c5 { stroke: var(--c5); stroke-width: 2.7; stroke-dasharray: 1.5 5; }
.c6 { stroke: var(--c6); stroke-width: 1; }
footer { margin-top: 48px; border-top: 1px solid var(--rule); padding-top: 10px; }
@page { size: A4; margin: 15mm 14mm 16mm; }
@media print {
  body { font-size: 9.5pt; line-height: 1.4; }
  main { max-width: none; padding: 0; }
  nav, .full, figure.diagram:target .scaled { display: none; }
  h1 { font-size: 20pt; } h2 { font-size: 14pt; margin-top: 22pt; } h3 { font-size: 11pt; }
  h4 { font-size: 9pt; }
  h2, h3, h4, h2 + p, h3 + p, thead { break-after: avoid; } tr, figure, .tile, li { break-inside: avoid; }
  table { font-size: 8.5pt; } th { font-size: 8pt; } .name { font-size: 7.8pt; }
  .about, .note, figcaption, .legend { font-size: 8pt; }
  .figures { grid-template-columns: 1fr 1fr; gap: 10pt; }
  figure.plot { border-color: #bbb; padding: 6pt 6pt 2pt; }
  .tiles { grid-template-columns: repeat(5, 1fr); gap: 6pt; } .tile b { font-size: 12.5pt; }
  .tile span { font-size: 7.5pt; } .wide { min-width: 0; width: 55%; }
  .table, .canvas { overflow: visible; } th.n, .share { white-space: normal; }
  .canvas { border: 0; padding: 0; }
  svg.drawing, figure.diagram:target svg.drawing { max-width: 100%; max-height: 225mm; width: auto; }
}
)";

}  // namespace

std::string escaped_lines(const std::string& text) {
  std::string html;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    html += (from > 0 ? "<br/>" : "") + escaped(text.substr(from, end - from));
    from = end + 1;
  }
  return html;
}

std::string page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n"
      "</html>\n",
      diagram::html(title), kStyle, body);
}

std::string power_of_ten(int exponent) {
  constexpr const char* digits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = exponent < 0 ? "10⁻" : "10";
  for (const char c : std::to_string(std::abs(exponent))) text += digits[c - '0'];
  return text;
}

std::string number(double x, int digits) {
  if (x == 0) return "0";
  if (!std::isfinite(x)) return fmt::format("{}", x);
  const double size = std::abs(x);
  if (size >= 1e-3 && size < 1e6) {
    const std::string text = fmt::format("{:.{}g}", x, size >= 1e4 ? std::max(digits, 6) : digits);
    return text.find('e') == std::string::npos ? text : fmt::format("{:.0f}", x);
  }
  const int exponent = static_cast<int>(std::floor(std::log10(size)));
  std::string mantissa = fmt::format("{:.{}g}", x / std::pow(10.0, exponent), std::min(digits, 3));
  return mantissa + "·" + power_of_ten(exponent);
}

}  // namespace titop::report
