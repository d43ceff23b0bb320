# pipelines/tidy.sh removes what killed runs left, and nothing else.
failed=0
bad() { echo "$*"; failed=1; }
host=$(hostname)
mkdir -p out/frames 'out/with blank'
sleep 1000 & living=$!
sh -c 'exit 0' & dead=$!
wait $dead
# What a killed run really leaves: the name of the temporary is made by the tool.
tool-probe room.glb --bytes 8MiB --pause 50000 -o out/frames/real.out 2>/dev/null & probe=$!
for round in 1 2 3 4 5 6 7 8 9 10; do [ -n "$(find out/frames -name '.real.out.tmp.*')" ] && break; sleep 0.1; done
kill -9 $probe 2>/dev/null; wait $probe 2>/dev/null
[ -n "$(find out/frames -name '.real.out.tmp.*')" ] || bad 'the killed probe left nothing: this test is void'

: > "out/with blank/.0001.exr.tmp.$host.$dead"
: > "out/.new.exr.tmp.otherhost.77"; : > "out/.old.exr.tmp.otherhost.77"
touch -d '2 days ago' "out/.old.exr.tmp.otherhost.77"
: > "out/.living.exr.tmp.$host.$living"
# Not ours, though alike:
keep="out/0001.exr out/0001.exr.tmp.$host.$dead out/.0001.exr.tmp out/.0001.exr.tmp.$host.x1 out/.0001.exr.tmp.$dead out/.tmp.$host.$dead
out/.0001.exr.tmp.$host.0 out/.0001.exr.tmp.$host.99999999999"
for file in $keep; do : > "$file"; touch -d '9 days ago' "$file"; done
mkdir "out/.folder.tmp.$host.$dead"
ln -s ../elsewhere "out/.link.tmp.$host.$dead"
mkdir elsewhere; : > "elsewhere/.0001.exr.tmp.$host.$dead"; ln -s ../elsewhere out/linked

tidy() { sh "$HERE/../../pipelines/tidy.sh" "$1"; }
tidy out > said || bad "tidy.sh exits $?"
grep -q '^removed 3 unfinished files, kept 2' said || bad "says: $(cat said)"
[ -z "$(find out -name '.real.out.tmp.*' -o -name '.old.exr.*')" ] && [ ! -e "out/with blank/.0001.exr.tmp.$host.$dead" ] ||
  bad 'left-overs are still there'
for file in $keep "out/.new.exr.tmp.otherhost.77" "out/.living.exr.tmp.$host.$living" "elsewhere/.0001.exr.tmp.$host.$dead"; do
  [ -e "$file" ] || bad "$file is gone"
done
[ -d "out/.folder.tmp.$host.$dead" ] && [ -L "out/.link.tmp.$host.$dead" ] || bad 'a folder or a link is gone'
kill $living
tidy nowhere 2> errors; [ $? = 2 ] && [ "$(wc -l < errors)" = 1 ] || bad "a folder that is not there: $(cat errors)"
exit $failed
