# Smoke seen in a mirror, and from within it: layers of the chain against path tracing. Noise of so few paths is up to 2 % of a layer;
# light that is counted twice, lost or not dimmed is 10 % and more.
command -v make-vdb > /dev/null || { echo 'built without volumes'; exit 77; }
bin=$(dirname "$(command -v frame-render)")
"${PYTHON:-python3}" -B "$HERE/../bench/smoky_rooms.py" "$bin" mirror inside --make-vdb make-vdb --folder rooms --seeds 1 --size 64x36 --paths 128 --limit 0.08
