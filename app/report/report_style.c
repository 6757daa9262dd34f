#include "report_style.h"

#include "wisp/base.h"

// The eight colours of Okabe and Ito, which are distinguishable for colour-blind readers, adjusted in lightness until
// each has a contrast of at least 3 with its background, in light and dark mode.
static const char* const colours[] = {
    ":root{color-scheme:light dark;--page:#f6f6f4;--card:#fff;--head:#f1f1ee}",
    ":root{--ink:#1c1d1f;--soft:#5c6066;--line:#dcdcd8;--faint:#ededea}",
    ":root{--link:#0a5a9c;--good:#00705a;--bad:#b3261e;--bad-page:#fdf1ef}",
    ":root{--s0:#0072b2;--s1:#c94f00;--s2:#00815f;--s3:#b4488a;--s4:#b07700;--s5:#2a8fc7;--s6:#4a4d52;--s7:#7f7a00}",
    "@media (prefers-color-scheme:dark){",
    ":root{--page:#131416;--card:#1b1d20;--head:#22252a}",
    ":root{--ink:#e6e6e3;--soft:#a2a6ac;--line:#34373c;--faint:#26292d}",
    ":root{--link:#7cb8ea;--good:#4cc9a4;--bad:#ff8a7d;--bad-page:#2b1b1a}",
    ":root{--s0:#4aa3e0;--s1:#f0803c;--s2:#2fb893;--s3:#dd8fbc;--s4:#e6a21a;--s5:#86ccf2;--s6:#c3c6cb;--s7:#d6cd3e}",
    "}",
    ".s0{color:var(--s0)}.s1{color:var(--s1)}.s2{color:var(--s2)}.s3{color:var(--s3)}",
    ".s4{color:var(--s4)}.s5{color:var(--s5)}.s6{color:var(--s6)}.s7{color:var(--s7)}",
};

static const char* const text[] = {
    "*{box-sizing:border-box}",
    "html{-webkit-text-size-adjust:100%;scroll-padding-top:1rem}",
    "body{margin:0;background:var(--page);color:var(--ink);overflow-wrap:break-word}",
    "body{font:1rem/1.55 system-ui,-apple-system,\"Segoe UI\",Roboto,\"Helvetica Neue\",Arial,sans-serif}",
    "body{font-variant-numeric:tabular-nums}",
    "header,main,nav{max-width:80rem;margin:0 auto;padding:0 clamp(1rem,4vw,3rem)}",
    "header{padding-top:clamp(1.75rem,5vw,4rem)}",
    "main{padding-bottom:4rem}",
    "h1{font-size:clamp(1.6rem,4vw,2.4rem);line-height:1.15;letter-spacing:-.02em;font-weight:650;margin:0}",
    "h2{font-size:1.35rem;letter-spacing:-.01em;font-weight:650;margin:3.5rem 0 1.25rem}",
    "h3{font-size:1rem;line-height:1.35;font-weight:600;margin:0}",
    "p{margin:0}",
    "a{color:var(--link);text-decoration:none}",
    "a:hover{text-decoration:underline}",
    ":focus-visible{outline:2px solid var(--link);outline-offset:2px}",
    ".over{color:var(--soft);font-size:.875rem;margin-bottom:.35rem}",
    ".how{color:var(--soft);margin-top:.5rem}",
    ".how:empty{display:none}",
    ".facts{display:grid;grid-template-columns:max-content 1fr;gap:.3rem 1.25rem;margin:1.5rem 0 0;font-size:.9rem}",
    ".facts dt{color:var(--soft)}",
    ".facts dd{margin:0}",
    ".verdict{margin-top:1.75rem;padding:.9rem 1.15rem;background:var(--card)}",
    ".verdict{border:1px solid var(--line);border-left:4px solid var(--good);border-radius:8px}",
    ".verdict strong{color:var(--good)}",
    ".verdict.failed{border-left-color:var(--bad);background:var(--bad-page)}",
    ".verdict.failed strong{color:var(--bad)}",
    ".verdict ul{margin:.6rem 0 0;padding-left:1.2rem}",
    ".verdict li{margin:.3rem 0}",
    ".conclusions{margin:.9rem 0;padding-left:1.2rem}",
    ".conclusions li{margin:.3rem 0}",
    "nav{margin-top:1.75rem;font-size:.9rem}",
    "nav summary{cursor:pointer;color:var(--soft)}",
    "nav ul{columns:22rem;column-gap:2.5rem;margin:.75rem 0 0;padding:0;list-style:none}",
    "nav li{break-inside:avoid;padding:.15rem 0}",
    "nav .part{font-weight:600;padding-top:.6rem;break-after:avoid}",
    ".notes{margin:0;padding-left:1.2rem;max-width:52rem}",
    ".notes li{margin:.55rem 0}",
};

static const char* const cards[] = {
    ".grid{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,31rem),1fr));gap:1.5rem}",
    ".card{margin:0;min-width:0;padding:1.15rem 1.25rem;break-inside:avoid}",
    ".card{background:var(--card);border:1px solid var(--line);border-radius:10px}",
    ".pictures{grid-template-columns:1fr}",
    ".picture img{display:block;max-width:100%;max-height:85vh;width:auto;height:auto;border-radius:6px}",
    ".picture figcaption{margin-top:.75rem;color:var(--soft);font-size:.9rem}",
    ".axis,th span{color:var(--soft);font-size:.8rem}",
    ".axis.y{margin:.75rem 0 .15rem}",
    ".axis.x{text-align:right}",
    ".axis span,th span{opacity:.75;font-weight:400}",
    ".axis span::before,th span::before{content:\"\\00b7\\00a0\"}",
    ".caption,.left-out,.empty{color:var(--soft);font-size:.85rem;margin-top:.75rem}",
    ".key{display:flex;flex-wrap:wrap;gap:.3rem 1.1rem;margin:.8rem 0 0;padding:0;list-style:none;font-size:.85rem}",
    ".key li{display:flex;align-items:center;gap:.45rem}",
    ".key svg{width:30px;height:16px;flex:none}",
    ".shapes{position:absolute}",
    ".plot{display:block;width:100%;height:auto;overflow:visible}",
    ".grid-line{stroke:var(--line);stroke-width:1;fill:none;vector-effect:non-scaling-stroke}",
    ".grid-line.minor{stroke:var(--faint)}",
    ".tick{font-size:12px;fill:var(--soft)}",
    ".tick.x{text-anchor:middle}",
    ".tick.y{text-anchor:end}",
    ".label{font-size:11.5px;fill:currentColor;stroke:var(--card);stroke-width:3;paint-order:stroke}",
    ".line{fill:none;stroke:currentColor;stroke-width:2;stroke-linejoin:round;vector-effect:non-scaling-stroke}",
    ".dashed .line,.line.dashed{stroke-dasharray:6 4}",
    "use{fill:currentColor;stroke:var(--card);stroke-width:1}",
    ".ring{fill:none;stroke:currentColor;stroke-width:1.75}",
    ".bars{border-collapse:collapse;width:100%;margin-top:.75rem;font-size:.85rem}",
    ".bars th{text-align:left;font-weight:400;padding:.2rem .75rem .2rem 0;width:36%}",
    ".bars th{vertical-align:top;line-height:1.35}",
    ".bars tr:first-child th{color:var(--soft);font-size:.8rem;padding-bottom:.35rem}",
    ".bars td{padding:.2rem 0;vertical-align:middle}",
    ".bars .first td,.bars .first th{border-top:1px solid var(--faint);padding-top:.35rem}",
    ".bars td svg{display:block}",
    ".bars rect,.key rect{fill:currentColor}",
    ".bars .n{padding-left:.75rem;width:5.5rem}",
    ".marked{font-weight:650}",
};

static const char* const tables[] = {
    ".table{margin:0 0 2.5rem}",
    ".table h3{margin-bottom:.7rem;max-width:60rem}",
    ".scroll{overflow:auto;width:fit-content;max-width:100%;max-height:85vh}",
    ".scroll{background:var(--card);border:1px solid var(--line);border-radius:10px}",
    ".data{border-collapse:separate;border-spacing:0;font-size:.82rem;line-height:1.4}",
    ".data th,.data td{padding:.42rem .8rem;text-align:left;vertical-align:top;border-bottom:1px solid var(--faint)}",
    ".data td{white-space:nowrap}",
    ".data tr:last-child td{border-bottom:0}",
    ".data th{position:sticky;top:0;z-index:1;min-width:5rem;vertical-align:bottom;text-wrap:balance}",
    ".data th{background:var(--head);border-bottom:1px solid var(--line);font-weight:600}",
    ".data tbody tr:hover td{background:var(--head)}",
    ".data .n,.bars .n{text-align:right}",
    ".data td.hash{font-family:ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;font-size:.92em}",
    "@media (min-width:48rem){",
    ".data th:first-child,.data td:first-child{position:sticky;left:0;background:var(--head)}",
    ".data th:first-child{z-index:2}",
    "}",
};

static const char* const media[] = {
    // A drawing shrinks with its card, but its letters must not.
    "@media print,(max-width:40rem){",
    ".tick{font-size:18px}",
    ".tick.x{transform:translateY(6px)}",
    "}",
    "@media (max-width:40rem){",
    ".card{padding:1rem}",
    ".label{display:none}",
    ".facts{grid-template-columns:1fr;gap:0}",
    ".facts dd{margin-bottom:.6rem}",
    ".bars th{width:42%}",
    ".bars .n{width:4rem}",
    "}",
    // Paper cannot scroll, so tables wrap there.
    "@media print{",
    ":root{--page:#fff}",
    "body{font-size:9.5pt}",
    "nav{display:none}",
    "header,main{max-width:none;padding-left:0;padding-right:0}",
    "h2,h3{break-after:avoid}",
    ".grid{grid-template-columns:1fr 1fr;gap:.75rem}",
    ".pictures{grid-template-columns:1fr}",
    ".scroll{overflow:visible;max-height:none;border:0}",
    ".data{font-size:6.5pt}",
    ".data th,.data td{padding:.15rem .3rem;position:static;white-space:normal;min-width:0;background:none}",
    ".data tr{break-inside:avoid}",
    ".hash{word-break:break-all}",
    "}",
    "@page{margin:12mm}",
};

static void put_lines( const char* const* lines, int count, FILE* stream )
{
    for ( int i = 0; i < count; ++i )
    {
        fprintf( stream, "%s\n", lines[i] );
    }
}

void report_put_style( FILE* stream )
{
    fputs( "<style>\n", stream );
    put_lines( colours, WISP_COUNT( colours ), stream );
    put_lines( text, WISP_COUNT( text ), stream );
    put_lines( cards, WISP_COUNT( cards ), stream );
    put_lines( tables, WISP_COUNT( tables ), stream );
    put_lines( media, WISP_COUNT( media ), stream );
    fputs( "</style>\n", stream );
}
