# look.mk -- pictures to look at, how wrong they are and what they cost. Included by Makefile.example; look.md is its page.
judged   = $(sort $(foreach f,$(if $(plan_frames),$(REPORT_FRAMES)),$(or $(picture_$(filter \
  $f 0$f 00$f 000$f,$(plan_frames))),$f-is-not-in-FRAMES)))
options_path    = --integrator path --halves --size $(SIZE) --spp $(PATHS) --channels RGBA --camera $(CAMERA) $(shared)
options_sheet   = --columns 8 --tile 160 $(frames)
options_report  = -o $(OUT)/report $(foreach f,$(judged),--run scene=$(basename \
  $(notdir $(SCENE))),curve=$(QUALITY),label=frame-$f $(subst + ,+,$(call spent,$f)) $(OUT)/error/$f.json)
$(if $(PLANNED),$(if $(plan_frames)$(DRY),$(foreach s,path sheet report,$(call note,$s))))

# To look at, at one exposure for the whole sequence: the one that suits the first frame.
$(OUT)/exposure: $(firstword $(frames)) $(BIN)/tempolux-info
	$(RUN) $(BIN)/tempolux-info $< --json | sed -n 's/.*"auto_exposure_stops": *\([^,]*\),*$$/\1/p' | grep . > $@
%.png: %.exr $$(OUT)/exposure
	$(RUN) $(BIN)/tempolux-info --png $@ --exposure $$(cat $(OUT)/exposure) $<
$(OUT)/sheet.png: $(frames) $(OUT)/exposure $(OUT)/options/sheet
	$(RUN) $(BIN)/tempolux-info --sheet $@ --exposure $$(cat $(OUT)/exposure) $(marks) $(options_sheet)

# How wrong is a frame? Against path tracing, unbiased, in two halves whose noise is known and taken out.
$(judged:%=$(OUT)/path/%.exr): $(OUT)/path/%.exr: $$(camera_$$*) $$(light_$$*) $(OUT)/options/path $(BIN)/frame-render
	$(RUN) $(BIN)/frame-render $(SCENE) --frame $* $(options_path) -o $@ --stats $(@:.exr=.json)
$(OUT)/error/%.json: $(OUT)/frames/%.exr $(OUT)/path/%.exr $(BIN)/aqm-compare
	$(RUN) $(BIN)/aqm-compare $< --reference-halves $(OUT)/path/$*_a.exr $(OUT)/path/$*_b.exr --json $@ --quiet
# And what did it cost? For each its error, and the processor seconds of all stages that lead to it.
spent = $(if $(raw),$(OUT)/raw/$1.json+)$(if $(plan_media),$(OUT)/clear/$1.json+)$(foreach s,$(if $(photons_$1),photons $(if $(filter paths,$(plan_indirect)),,$(or $(textured),points $(split_stage) $(if $(records),cache)))),$(OUT)/$s/$(photons_$1).json+)$(if \
  $(stands_$(photons_$1)),$(call spent_on_segment,$(stands_$(photons_$1))))$(addsuffix +,$(patsubst %.lightgrid,%.json,$(call lights_of,$1)))$(OUT)/frames/$1.json
$(OUT)/report/index.html: $(judged:%=$(OUT)/error/%.json) $(OUT)/options/report $(BIN)/error-report
	$(RUN) $(BIN)/error-report $(options_report)
report: $(OUT)/report/index.html $(kept_report) ; @cat $(OUT)/report/report.md $(kept_report)
estimate: $(BIN)/scene-plan # processor seconds and bytes of all that `demo` would make
	@$< $(options_plan) --estimate --jobs 2 --photon-options '--photons $(PHOTONS) $(shared)' --point-options '$(options_points)' \
	  --cache-options '$(options_cache)' --frame-options '$(options_frames) $(filter --learn-lights,$(PIXELS))'
