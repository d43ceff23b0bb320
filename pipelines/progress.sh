#!/bin/sh
# progress.sh -- prints the progress of make. run.sh and stages.mk run it inside OUT.
#
#     progress.sh begin        how much there is to do
#     progress.sh job NAME     after a job (jobs.sh):  [12/49] 0:41, about 4:50 left: frame 3, done
#     progress.sh say FILE     before the command that makes FILE, with RUN after it:
#                              [12/97] 0:41, about 4:50 left: frame 3, pixels
#     progress.sh end          after the last one: what the frames cost, how noisy they are, where to look
#     progress.sh failed GOAL  after a make that failed: what was made, which file was not and why
#
# The environment has PROGRESS, a file that gets a line for each command that has begun (with RUN: has ended); TOTAL,
# the number of commands; WEIGHT, their estimated CPU seconds in all (progress.sh weigh); BEGAN, the time at which the
# first one began (date +%s); FAILED, a file with a line for each command that has not made its file (made.sh).
: "${PLAN:=plan.mk}" "${PLAN_JSON:=plan.json}"
clock() {
  if [ "$1" -lt 3600 ]; then printf '%d:%02d' $(($1 / 60)) $(($1 % 60))
  else printf '%d h %02d min' $(($1 / 3600)) $(($1 % 3600 / 60)); fi
}

# Prints a line for each stage of the plan: FOLDER PART CPU_SECONDS WORDS.
stages() {
  awk -F '"' '$2 == "segments" { exit } $2 == "folder" { folder = $4 } $2 == "part" { part = $4 }
    $2 == "words" { words = $4 }
    $2 == "cpu_s" { gsub(/[: ,]/, "", $3); print folder, part, $3, words }' "$PLAN_JSON"
}

# Estimated CPU seconds of the commands for the file names on standard input.
weigh() {
  { stages; echo; cat; } | awk -F '[ /]' '!NF { files = 1 } !files { cost[$1] = $3 } files { sum += cost[$1] }
    END { printf "%.1f", sum }'
}

say() {
  [ -n "$PROGRESS" ] || return 0   # make has not begun: an estimate runs, or a user runs stages.mk
  echo "$1" >> "$PROGRESS"
  n=$(grep -nxF -- "$1" "$PROGRESS" | tail -1 | cut -d: -f1)   # number of this command; other jobs may have added lines
  [ "$n" -le "$TOTAL" ] || TOTAL=$n   # a walkthrough adds keys as it goes
  passed=$(($(date +%s) - BEGAN))
  left=
  [ "$passed" -lt 10 ] || left=$(sed "${RUN:+#}\$d" "$PROGRESS" | weigh | awk -v passed="$passed" -v all="$WEIGHT" \
    '$1 > .1 * all && $1 < all { printf "%d", passed * (all - $1) / $1 }')
  [ -z "$left" ] || left=", about $(clock "$left") left"
  echo "[$((n))/$TOTAL] $(clock "$passed")$left: $(in_words "$1")"
}

job() {   # after a job: JOBS is the list, a line of PROGRESS a job that has ended
  [ -n "$PROGRESS" ] || return 0
  echo "$1" >> "$PROGRESS"
  awk -F '\t' -v jobs="$JOBS" -v name="$1" -v began="$BEGAN" -v now="$(date +%s)" '
    { done[$1]; ++n }
    END {
      while ((getline < jobs) > 0) { ++all; work += $3; if ($1 in done) made += $3; if ($1 == name) makes = $5 }
      split(makes, file, " ")
      left = now - began >= 10 && made > .1 * work && made < work ? (now - began) * (work - made) / made : 0
      printf "%d %d %d %d %s\n", n, all, now - began, left, file[1]
    }' "$PROGRESS" | {
    read -r n all passed left file
    [ "$left" = 0 ] && left= || left=", about $(clock "$left") left"
    echo "[$n/$all] $(clock "$passed")$left: $(in_words "$file")"
  }
}

in_words() {   # a file inside OUT, by the frame that was asked for
  name=${1##*/} folder=${1%/*}
  frame=${name%%[-.]*}
  words=$(stages | sed -n "s/^$folder //p")   # PART CPU_SECONDS WORDS
  part=${words%% *} words=${words#* * }
  case $1 in
    demo) echo 'sheet and previews'; return;;
    shown/*) words=done part=frames;;
  esac
  case $frame in
    *[!0-9+]*) echo "$folder"; return;;
    *+*) echo "frames $(number "${frame%+*}") to $(number "${frame#*+}"), $words"; return;;
  esac
  # A frame that looks the same was asked for, or frames that share its light.
  if ! grep -q "^frames/${frame}[.]exr:" "$PLAN"; then
    alike=$(sed -n "s|^frames/\([0-9]*\)[.]exr: .*[a-z]/$frame-.*|\1|p" "$PLAN" | head -1)
    case $alike,$part in
      ?*,*) frame=$alike;;
      ,frames | ,report) ;;   # a neighbour, a key
      *) echo "$words"; return;;
    esac
  fi
  echo "frame $(number "$frame"), $words"
}

number() { n_=${1#"${1%%[!0]*}"}; echo "${n_:-0}"; }   # 0012 -> 12

count() { sed -n "s/^$1 := //p" "$PLAN" | wc -w; }

of() { [ "$1" = 1 ] && echo "1 $2" || echo "$1 $2s"; }   # of 3 frame -> 3 frames

# How the frames get their indirect light, as the plan chose; plan.json says why.
ways() {
  awk -F '[":, ]+' '
    BEGIN { words["paths"] = "camera paths"; words["gather"] = "gathering"; words["records"] = "records" }
    $2 == "indirect" { way = words[$3] }
    $2 == "texture_width" { way = $3 > 0 ? "light textures" : way; if (!seen[way]++) all = all (all ? " and " : "") way }
    END { if (all) print "; indirect light by " all }' "$PLAN_JSON"
}

begin() {
  echo "$(of "$(count frames)" frame) of $SIZE, $QUALITY: $(of "$TOTAL" "${UNIT:-command}") to run (V=1 shows them)$(ways)"
  [ "$METHOD" != walkthrough ] || grep -q '"walkthrough": true' "$PLAN_JSON" ||
    sed -n '/"ibr-warp": "/ { s/.*: "\(.*\)",*$/METHOD=walkthrough: no frame is warped: \1/; p; q; }' "$PLAN_JSON"
}

# The largest share of the pixels in which a viewer sees noise, in percent, if `make measure` has measured pictures of
# this plan; else nothing.
measured() {
  [ -f measured.json ] || return 0
  sed -n 's/.*"picture": "\([^"]*\)", "tried": \[{"photons": 0, "aqm": \([0-9.e+-]*\)}\].*/\1 \2/p' measured.json |
    while read -r picture share; do ! grep -qF "\"$picture\"" "$PLAN_JSON" || echo "$share"; done |
    sort -g | awk 'END { if (NR) printf "%.1f", 100 * $1 }'
}

# advice LAYER WAYS: what lowers the noise of a layer of frames whose indirect light is found so (ways).
# Emission and direct light are noisy where edges or cut-outs fill a small part of a pixel, or in half shadow.
advice() {
  more='a smaller ERROR takes more samples'
  case $1,$2 in
    emission,*) echo "$more of edges and cut-outs";;
    direct,*) echo "$more of lamps, edges and cut-outs";;
    specular,*) echo "$more of mirrors and glass; a little roughness spreads their bright points";;
    caustic,*paths*) echo "INDIRECT=gather or records finds caustics by photons";;
    caustic,*) echo 'more photons (PHOTONS) make caustics smooth';;
    indirect,*paths*) echo "INDIRECT=records or METHOD=preview finds light that samples seldom meet, and $more";;
    indirect,*gathering*) echo "$more, and more photons (PHOTONS) smooth what they gather";;
    indirect,*) echo 'more photons (PHOTONS) make indirect light smooth';;
    volume,*paths*) echo "$more of smoke";;
    volume,*) echo 'more photons (PHOTONS) make smoke smooth';;
    *) echo "$more";;
  esac
}

# Sets `audit` to the account of the frames; it may be empty. The statistics show that RUN has run the command.
account() {
  . "${0%/*}/made.sh"
  ran=state/.account.tmp.$(uname -n).$$ text=$ran.text wanted=audit
  trap 'rm -f "$ran" "$text"' EXIT
  # shellcheck disable=SC2086
  made "$ran" -- $RUN "$BIN/tempolux-info" --account $frames --stats "$ran" > "$text" || return
  audit=$(cat "$text")
}

# Adds up the statistics of all commands that led to the frames, also those of earlier makes, but not the comparison
# with path tracing. Noise is printed in brightness steps of a screen, of which white has 255: the root mean square over
# the frames. The audit is the bias that frames report of their own light. A warning follows if a
# frame has ten times the noise that is asked for (pipelines/look.md), or if all frames are black. What the warning
# advises follows from the layer that has the most noise in this frame.
end() {
  asked=$ERROR
  [ -n "$asked" ] || [ -n "$PIXELS" ] || case $QUALITY in draft) asked=.05;; *) asked=.016;; esac   # as stages.cpp
  frames=$(sed -n 's/^frames := //p' "$PLAN")
  account || return
  [ -n "$audit" ] || if grep -q '^[a-z]*/.*words := .*--audit ' "$PLAN"
    then audit='not audited, too few of the tested paths bring light'
    else audit='not audited, as no preview is'; fi
  sed -n 's|^\([a-z_]*/[^.: ]*\)[^:]*: words :=.*|\1.json|p' "$PLAN" |
    grep -v "$(stages | sed -n 's|^\([a-z_]*\) report .*|^\1/|p')" |
    awk -v frames="$(count frames)" -v shown="$(of "$(count frames)" frame) of $SIZE" -v audit="$audit" -v out="$OUT" \
      -v seen="$(measured)" -v asked="$asked" '
      function value(line) { sub(/.*: */, "", line); return line + 0 }
      {
        folder = $0; sub("/.*", "", folder); whole = 1; layer = ""; of_layer = 0; worse = 0
        while ((getline line < $0) > 0) {
          if (whole && line ~ /"cpu_s":/) { cpu += value(line); whole = 0 }   # the first is of the whole command
          if (line ~ /"mean_radiance":/) { seen_all++; seen_black += value(line) == 0 }
          if (line ~ /"noise.codes":/) {
            one = value(line); noise[folder] += one ^ 2; counted[folder]++
            if (one > most[folder]) {
              most[folder] = one; worst[folder] = $0
              sub(/^[^\/]*\/0*/, "", worst[folder]); sub(/[^0-9].*/, "", worst[folder]); worse = 1
            }
          }
          if (line ~ /"noise.[a-z]+.codes":/) {
            name = line; gsub(/^.*noise[.]|[.]codes.*$/, "", name); one = value(line)
            if (one > of_layer) { of_layer = one; layer = name }
          }
        }
        close($0)
        if (worse) noisiest[folder] = layer
      }
      END {
        printf "%s: %.*f CPU s in all, %.1f a frame", shown, cpu < 10, cpu, cpu / frames
        last = counted["filtered"] ? "filtered" : counted["pictures"] ? "pictures" : counted["raw"] ? "raw" : "keys"
        if (counted[last]) printf "; noise, without bias, %.1f of 255 brightness steps", sqrt(noise[last] / counted[last])
        if (last == "raw") printf " before the filter"
        if (seen != "") printf "; a viewer sees noise in %s %% of the pixels (make measure)", seen
        printf "; %s; look at %s/sheet.png\n", audit, out
        if (seen_all && seen_black == seen_all)
          printf "warning: all is black: the camera sees neither a lamp nor a lit surface; CAMERA=NAME takes another " \
            "camera, SKY=1,1,1 adds light from all directions\n"
        # A pixel error e leaves about 305 x .18 e codes (lib/render/frame_noise.h).
        promised = 305 * .18 * asked
        if (promised > 0 && most[last] > 10 * promised)
          printf "warning: noise is seen: frame %d has %.0f brightness steps of noise%s, %.1f are asked for; " \
            "ADVICE %s\n", worst[last], most[last], noisiest[last] ? ", most of it in layer " noisiest[last] : "", promised,
            noisiest[last]
      }' |
    while IFS= read -r line; do
      case $line in *'; ADVICE '*) echo "${line%ADVICE *}$(advice "${line##* }" "$(ways)")";; *) echo "$line";; esac
    done
}

shown() {   # number of frames that show what the plan wants
  awk '/^frames\/[^:]*[.]exr: [|] shown/ { print $3 }' "$PLAN" |
    while read -r marker; do [ ! -e "$marker" ] || echo; done | wc -l
}

failed() {   # failed GOAL
  said=
  [ "$1" != demo ] || said="$(shown) of $(of "$(count frames)" frame) made. "
  if [ -s "$FAILED" ]; then
    IFS='	' read -r file tool why < "$FAILED"
    said="${said}Not made: $(in_words "$file") ($file): $tool $why. "
    others=$(($(wc -l < "$FAILED") - 1))
    [ $others = 0 ] || said="${said}$(of $others 'more command') failed. "
  fi
  echo "${said}Type the same command again: it makes what is missing"
}

case $1 in
  job) job "$2";;
  say) say "$2";;
  failed) failed "$2";;
  advice) advice "$2" "$3";;
  begin | weigh | end) $1;;
  *) echo "progress.sh: '$1' is none of begin, say, weigh, end" >&2; exit 2;;
esac
