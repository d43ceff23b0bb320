# error-report: a report from known curves, alike each time it is made; refusals; gnuplot missing.
tool=$(command -v error-report)
try() { echo "> error-report $*"; PATH=/nowhere "$tool" "$@"; echo "exit $?"; }   # finds no gnuplot
"${PYTHON:-python3}" - <<'END'
import json
def write(name, **keys):
    json.dump({"version": "1.0", **keys}, open(name, "w"))
def run(curve, x, time, mse):
    stem = f"{curve[0]}{x}"
    write(stem + ".s.json", schema="tempolux.stats", tool="frame-render", cpu_s=time, wall_s=time / 2,
          peak_memory_bytes=5000000, phases=[{"name": "render", "cpu_s": time, "wall_s": time / 2}], counts={"rays": 100 * x})
    write(stem + ".c.json", schema="tempolux.comparison", mode="reference_halves", layer="RGB", frames=[{}],
          total={"pixels": 512, "mse": mse, "mse_standard_error": mse / 100, "bias": None})
    return {"scene": "S2", "curve": curve, "x": x, "label": f"{curve} {x}", "stats": [stem + ".s.json"],
            "comparison": stem + ".c.json"}
runs = [run("path", 4**i, 0.5 * 4**i, 1e-2 / 4**i) for i in range(5)]
runs += [run("gather", 4**i, 0.5 * 4**i, 1e-3 / 4**i + 1e-5) for i in range(5)]
write("manifest.json", schema="tempolux.report", title="Known curves", runs=runs,
      points=[{"scene": "S2", "label": "peer", "cpu_s": 8, "rmse": 0.02}])
write("bad-point.json", schema="tempolux.report", runs=[], points=[{"label": "peer", "cpu_s": 0, "rmse": 1}])
END
try manifest.json -o plain
cat plain/report.md; ls plain
grep -c '<table>' plain/index.html; grep -c 'src="[^d]\|href=' plain/index.html
try --run 'scene=S2,curve=path,x=1,spp=1' p1.s.json+p4.s.json p1.c.json -o one; tail -n +7 one/report.md | head -3
try --run curve=a,x=1 p1.s.json p1.c.json --run curve=b,x=2 p4.s.json p4.c.json -o two; grep -c "^| [ab] | [ab] " two/report.md
try
try manifest.json --no-such
try p1.s.json
try missing.json
try bad-point.json -o bad
try --run curve=a,x=1 p1.s.json p1.s.json -o bad
try manifest.json -o manifest.json
ls -d report bad 2>/dev/null
command -v gnuplot >/dev/null || exit 0
error-report manifest.json -o r1 && error-report manifest.json -o r2 && diff -r r1 r2; ls r1 | tr '\n' ' '
grep -c 'slope -0.50' r1/error-S2.svg; grep -c 'bias floor 0.0032' r1/error-S2.svg; grep -c 'data:image/svg' r1/index.html
