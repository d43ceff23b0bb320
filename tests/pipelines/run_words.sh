#!/bin/sh
# Words of RUN that are filled in, and what a command is given when it runs again: sh tests/pipelines/run_words.sh BIN
# Run at the top of the tree; BIN is the folder with the tools. made.sh runs a command that takes no time.
# Seen to fail: {mem} filled in in the names of files too; a second round without twice the memory.
export BIN="$1" PIPELINES="$PWD/pipelines" WAIT=0 RETRIES=2 THREADS=3 FAILED=
work=$(mktemp -d) || exit 3
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 3
failed=0
# queue.sh WORDS... -- COMMAND: notes its words; runs the command the second time.
cat > queue.sh << 'END'
[ "$*" = "" ] || echo "$1" >> said
round=$(wc -l < said); shift
[ "$round" -lt 2 ] || exec "$@"
END
is() { [ "$1" = "$2" ] || { echo "FAILED: $3: '$1', expected '$2'"; failed=1; }; }
made() {   # made FILE
  rm -f said "$1"
  sh "$PIPELINES/made.sh" "$1" -- $RUN cp "{mem} b" "$1" 2> errors
  is $? 0 "exit code of $1"
}
echo text > '{mem} b'
export RUN='sh queue.sh --mem={mem},--time={time},-c{threads}'
# A stage, in a plan: 100 MB and 3601.5 CPU seconds: 1.5 x 100 + 65 MB, 2 x 3601.5 + 61 s; then twice as much.
mkdir raw
printf '  {"file": "%s", "cpu_s": %s, "memory": %s},\n' cache/0-1.irradcache 9 900000000 raw/0-1.exr 3601.5 100000000 \
  > plan.json
: > plan.mk
sh "$PIPELINES/jobs.sh" needs > needs
export NEEDS="$work/needs"
made 'raw/{mem}'
is "$(paste -sd' ' said)" '--mem=215M,--time=2:01:04,-c3 --mem=430M,--time=4:02:08,-c3' 'a stage'
lost='raw/{mem}: not made: sh ended with 0, but raw/{mem} is not there; RUN has lost the command'
is "$(cat errors)" "$lost; it is run again (1 of 2)" 'a line'
# A file of no stage gets as much as the largest of each; a job what its list says; before a plan, 1 GB and half an
# hour.
made preview
is "$(head -1 said)" '--mem=1415M,--time=2:01:04,-c3' 'a preview'
NEED='558 65' made job
is "$(head -1 said)" '--mem=558M,--time=0:01:05,-c3' 'a job'
NEEDS='' made plan
is "$(head -1 said)" '--mem=1024M,--time=0:30:00,-c3' 'before there is a plan'
# A command that a queue has refused gets no more.
echo 'echo "$1" >> said; shift; [ $(wc -l < said) -gt 1 ] || exit 1; exec "$@"' > queue.sh
made raw/b
is "$(paste -sd' ' said)" '--mem=215M,--time=2:01:04,-c3 --mem=215M,--time=2:01:04,-c3' 'refused'
# RUN without such words is left as it is.
RUN='sh queue.sh a' made b
is "$(paste -sd' ' said)" 'a a' 'no words'
[ $failed = 0 ] && echo ok
exit $failed
