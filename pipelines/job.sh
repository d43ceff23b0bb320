#!/bin/sh
# job.sh -- runs a job, which makes several files (jobs.sh). Run inside OUT.
#
#     job.sh run NAME                   on the machine of make: runs the job by RUN, and looks whether its files are
#                                       there
#     job.sh inside FILE... -- FILE...  on the machine of the job: makes these files, one command after the other; those
#                                       after -- only if the exposure of the pictures is known there
#
# The environment has what stages.mk needs, and JOBS: a file with the list of jobs. What fails is named on the machine
# of the job by made.sh; the exit code is that of the first tool that failed, so that a command that has refused its
# input is not run again.
. "${0%/*}/made.sh"

run() {
  keyed=yes called=job
  # Reads from the job's line in the list: what made.sh asks RUN for, the files, the optional files.
  { read -r NEED; read -r makes; read -r also; } << END
$(awk -F '\t' -v name="$1" '$1 == name { print $2, $3; print $5; print $6 }' "$JOBS")
END
  checked=$makes
  [ "$makes" != demo ] || checked=$(sed -n 's|^sheet.png: . \([^ ]*\) .*|\1|p' "$PLAN")
  # shellcheck disable=SC2086
  made $checked -- $RUN sh "$PIPELINES/job.sh" inside $makes -- $also || exit
  sh "$PIPELINES/progress.sh" job "$1"
}

makes() {
  # shellcheck disable=SC2086
  ending env -u MAKEFLAGS -u MFLAGS -u MAKELEVEL -u JOBS -u NEED RUN= PROGRESS= CLAIMS= FAILED="$failures" \
    make -k -s --no-print-directory -f "$RULES" PLAN="$PLAN" "$@" > /dev/null
}

inside() {
  failures=$(mktemp) || exit 3
  trap 'rm -f "$failures"' EXIT
  files=
  while [ "$1" != -- ]; do files="$files $1"; shift; done
  shift
  # shellcheck disable=SC2086
  makes $files || {
    code=$(sed -n '1s/.*ended with \([23]\)$/\1/p' "$failures")
    exit "${code:-1}"
  }
  exposure=$(sed -n 's|^\(shown/exposure-[^:]*\):.*|\1|p' "$PLAN")
  case " $* " in *" $exposure "*) ;; *) [ $# -gt 0 ] && [ -e "$exposure" ] || exit 0;; esac
  makes "$@"
  exit 0   # the last job makes previews that are missing
}

case $1 in
  run) run "$2";;
  inside) shift; inside "$@";;
  *) echo "job.sh: '$1' is none of run, inside" >&2; exit 2;;
esac
