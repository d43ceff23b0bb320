# stages.mk -- how make runs the commands of the pipeline. Run inside OUT by run.sh.
#
# plan.mk, written by scene-plan, lists the files of this run and has the rule of each stage (formats/plan/plan.md):
#     points/0012-bcbdec5026.irradpoints: words := --frame 12 --photons photons/0012-6706adedf0.photons
#     points/0012-bcbdec5026.irradpoints: | photons/0012-6706adedf0.photons
#     points/%.irradpoints:
#             $(run) points/$*.irradpoints $(tool)irradcache-build points $(drawn) -o points/$*.irradpoints ...; }
# `words` are options of the command. Files after the bar must exist before. The digits after the frame are a hash of
# everything that the file is made from, including this page. So a file that exists is up to date, and times are not
# compared. To replace a stage by a program of your own, write its rule at the end of this page: it replaces that of
# plan.mk.
PLAN = plan.mk
export PLAN
include $(PLAN)
# An empty variable leaves out its option. Names of files stay in the environment.
shared = $${ENVIRONMENT:+--environment "$$ENVIRONMENT"} $${SKY:+--environment "$$SKY"} \
  $${VOLUME:+--volume "$$VOLUME"} $${LIGHT_UNITS:+--light-units "$$LIGHT_UNITS"} $$VOLUME_OPTIONS $$TIME \
  $${SHUTTER:+--shutter "$$SHUTTER"} $${SHUTTER_OPEN:+--shutter-open "$$SHUTTER_OPEN"}
export TEMPOLUX_SAID = state/warnings# warnings of scene-plan: the stages do not repeat them
scene  = "$$SCENE" $(words) $(shared) --camera "$$CAMERA"
drawn  = $(scene) $(seed)
seen   = $(drawn) $(lens)
lens   = $${FSTOP:+--f-stop "$$FSTOP"} $${FOCUS:+--focus "$$FOCUS"} $${SENSOR_WIDTH:+--sensor-width "$$SENSOR_WIDTH"}
# Other random numbers, for `make measure` alone: it has its own folder, because keys do not include the seed.
seed   = $${MEASURE_SEED:+--seed "$$MEASURE_SEED"}
# Words about the command; run.sh counts them before. With RUN it may wait in a queue, so made.sh says them when it has
# ended.
say    = $(if $V,,$(if $(RUN),:,sh) "$$PIPELINES/progress.sh" say $@ &&)
# A rule is `$(run) FILES $(tool)TOOL OPTIONS; }`: it runs a tool and looks whether it has made these files; with V=1
# it shows the command (made.sh). follow.sh may have made the file before make comes to it. exec: what stops make stops
# the command.
run    = @test -f $@ || { $(say)exec sh "$$PIPELINES/made.sh"
tool   = -- $(RUN) "$$BIN"/
# make runs a line that contains $(MAKE) even with -n: here a variable holds it.
dry    = $(findstring n,$(filter-out --%,$(firstword -$(MAKEFLAGS))))
make_files = MAKE_FILES='$(MAKE) -f "$$RULES" PLAN="$(PLAN)"'
# After a picture: raw frames that were read are removed, and what waits for the picture alone is made at once, so that
# frames are shown while others are rendered.
read   = $(filter $(passing),$|)
follow = $(if $(dry),,$(if $(read)$(filter demo,$(MAKECMDGOALS)),+@exec env $(make_files) \
  sh "$$PIPELINES/follow.sh" made "$(filter demo,$(MAKECMDGOALS))" $@ $(read)))
.SUFFIXES:
.PHONY: demo report
demo: $(frames) $(previews) sheet.png $(log)
# A finished file is never removed when make fails or is stopped. Raw frames that were read are not made again. (An
# empty list would mean all files.)
.SECONDARY: raw/none $(passing)
.PRECIOUS: $(pictures:%=%/%.exr)

# Stages that ask before they run: between keys an interval is warped or halved (walkthrough.sh decides), then each of
# its frames is warped and completed.
walk/%.done:
	$(walk_rule)
walked/%.exr:
	@$(say)exec env SHARED="$(shared)" sh "$$PIPELINES/walkthrough.sh" frame $@ $(words)
	$(follow)
walk_rule = $(if $(dry),,+)@$(say)exec env $(make_files) SHARED="$(shared)" \
  sh "$$PIPELINES/walkthrough.sh" interval $@ $(words)

# Files that a user looks at: frames, previews, the sheet, a walkthrough's log (show.sh). shown/WHAT-KEY is the marker
# of a file: if it is missing, the file is made, and a file that was removed is made again.
marker = $(firstword $(filter shown/%,$@ $|))
show = exec sh "$$PIPELINES/show.sh" $(marker) $(filter-out $(frames) $(marker),$|)
shown/%:
	@test -f $@ || $(show)
$(frames) $(previews) sheet.png walk.log:
	@test -f $@ || $(show)

# The page of the report: errors against path tracing, and the cost of all stages.
show_report = @test -f $@ || exec sh "$$PIPELINES/show.sh" $(marker) $(report_runs)
shown/report-%:
	$(show_report)
report/index.html:
	$(show_report)
report: report/index.html
	@cat report/report.md
