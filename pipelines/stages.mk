# stages.mk -- one rule for each kind of file of the pipeline. Run inside OUT by run.sh.
#
# plan.mk, written by scene-plan, lists the files of this run (formats/plan/plan.md). It has two lines for each file:
#     points/0012-bcbdec5026.irradpoints: words := --frame 12 --photons photons/0012-6706adedf0.photons
#     points/0012-bcbdec5026.irradpoints: | photons/0012-6706adedf0.photons
# `words` are options of the command below. Files after the bar must exist before. The digits after the frame are a hash
# of everything that the file is made from, including the rules of this page. So a file that exists is up to date, and
# times are not compared. To replace a stage by a program of your own, change its rule here.
PLAN = plan.mk
export PLAN
include $(PLAN)
# An empty variable leaves out its option. Names of files stay in the environment.
shared = $${ENVIRONMENT:+--environment "$$ENVIRONMENT"} $${SKY:+--environment "$$SKY"} \
  $${VOLUME:+--volume "$$VOLUME"} $${LIGHT_UNITS:+--light-units "$$LIGHT_UNITS"} $$VOLUME_OPTIONS $$TIME
export TEMPOLUX_SAID = state/warnings# warnings of scene-plan: the stages do not repeat them
scene  = "$$SCENE" $(words) $(shared)
drawn  = $(scene) $(seed)
seen   = $(drawn) --camera "$$CAMERA"
# Other random numbers, for `make measure` alone: it has its own folder, because keys do not include the seed.
seed   = $${MEASURE_SEED:+--seed "$$MEASURE_SEED"}
say    = $(if $V,,sh "$$PIPELINES/progress.sh" say $@ &&)# counted by run.sh before
# Runs a tool and looks whether it has made its files; with V=1 shows the command (made.sh). exec: what stops make stops
# the command.
made   = exec sh "$$PIPELINES/made.sh" $1 -- $(RUN) "$$BIN"
run    = @$(say)$(call made,$@)
unless = @test -f $@ || { $(say)# of files that follow.sh may have made before make comes to them
# make runs a line that contains $(MAKE) even with -n: here a variable holds it.
dry    = $(findstring n,$(filter-out --%,$(firstword -$(MAKEFLAGS))))
make_files = MAKE_FILES='$(MAKE) -f "$$RULES" PLAN="$(PLAN)"'
# After a picture: what waits for it alone is made at once, so that frames are shown while others are rendered.
follow = $(if $(dry),,$(if $(filter demo,$(MAKECMDGOALS)),+@exec env $(make_files) \
  sh "$$PIPELINES/follow.sh" next $@))
.SUFFIXES:
.PHONY: demo report
demo: $(frames) $(previews) sheet.png $(log)
# A finished file is never removed when make fails or is stopped. Raw frames that were read are not made again. (An
# empty list would mean all files.)
.SECONDARY: raw/none $(passing)
.PRECIOUS: $(foreach f,pictures raw filtered smoky keys walked,$f/%.exr)

# Light: the photons of a state of light. With movers, first the photons of the static scene, then the changes by
# movers.
photons/%.photons:
	$(run)/photon-trace $(drawn) -o $@ --stats photons/$*.json
stands/%.photons stands/%.paths:
	@$(say)$(call made,stands/$*.photons stands/$*.paths)/photon-trace $(drawn) -o stands/$*.photons \
	  --paths stands/$*.paths --stats stands/$*.json
moved/%.photons:
	$(run)/photon-trace $(drawn) -o $@ --stats moved/$*.json
refined/%.photons:
	$(run)/photon-trace $(drawn) -o $@ --stats refined/$*.json

# Light of photons on all surfaces: irradiance points, which gather rays read. Bright points are separated where it
# pays.
points/%.irradpoints:
	$(run)/irradcache-build points $(drawn) -o $@ --stats points/$*.json
stands_points/%.irradpoints:
	$(run)/irradcache-build points $(drawn) -o $@ --stats stands_points/$*.json
split/%.low.irradpoints split/%.high.irradpoints:
	@$(say)$(call made,split/$*.low.irradpoints split/$*.high.irradpoints)/photonmap-split $(words) \
	  --low split/$*.low.irradpoints --high split/$*.high.irradpoints --stats split/$*.json

# Indirect light, gathered in records where the cameras need them. kept: records that keep their gathered light over
# time.
cache/%.irradcache:
	$(run)/irradcache-build records $(seen) -o $@ --stats cache/$*.json
stands_cache/%.irradcache:
	$(run)/irradcache-build records $(seen) -o $@ --stats stands_cache/$*.json
kept/%.irradcache kept/%.radsamples:
	@$(say)$(call made,kept/$*.irradcache kept/$*.radsamples)/gather-temporal final $(seen) \
	  -o kept/$*.radsamples --cache kept/$*.irradcache --stats kept/$*.json
# In previews: light textures, which count photons in elements of the surfaces and smooth them. windows: the
# photons of many frames.
counts/%.meshirrad:
	$(run)/st-filter mesh $(scene) -o $@ --stats counts/$*.json
windows/%.meshirrad:
	$(run)/gather-temporal density $(scene) -o $@ --stats windows/$*.json

# Pixels. raw: frames in two halves of samples, for the filter; removed when they were filtered. keys: frames for
# warping. smoky: frames with smoke.
pictures/%.exr:
	$(run)/frame-render $(seen) -o $@ --stats pictures/$*.json
	$(follow)
raw/%.exr:
	$(run)/frame-render $(seen) -o $@ --stats raw/$*.json
	$(follow)
filtered/%.exr:
	$(unless)$(call made,$@)/st-filter $(words) -o $@ --stats filtered/$*.json; }
	@sh "$$PIPELINES/follow.sh" read $(filter $(passing),$|)
	$(follow)
smoky/%.exr:
	$(unless)$(call made,$@)/volume-compose $(seen) -o $@ --stats smoky/$*.json; }
	$(follow)
keys/%.exr:
	$(run)/frame-render $(seen) -o $@ --stats keys/$*.json
	$(follow)
# Between keys: an interval is warped or halved (walkthrough.sh decides); then each of its frames is warped and
# completed.
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

# Compares frames with path tracing in two halves, whose noise is known, and adds up the cost of all stages.
path/%.exr path/%_a.exr path/%_b.exr:
	@$(say)$(call made,path/$*.exr path/$*_a.exr path/$*_b.exr)/frame-render $(seen) -o path/$*.exr \
	  --stats path/$*.json
error/%.json:
	$(run)/aqm-compare $(words) --json $@ --quiet
title = "$$(basename -- "$$SCENE"): error against time"
write_report = sh "$$PIPELINES/made.sh" report/index.html -- $(RUN) "$$BIN"/error-report -o report --title $(title) \
  $(report_runs) && rm -f shown/report-* && touch $(marker)
shown/report-%:
	@$(write_report)
report/index.html:
	@test -f $@ || { $(write_report); }
report: report/index.html
	@cat report/report.md
