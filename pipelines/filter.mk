# pipelines/filter.mk -- FILTER=N: each frame is rendered with few samples and filtered with those around it, N in all, N odd.
# Included by Makefile.example in place of its rule for pictures; filter.md is its page.
ifeq ($(QUALITY),draft)
FILTER_SPP = 1#          samples of each pixel; light that passes the filter, in mirrors and glass, gets more, as many as PIXELS gives it
else
FILTER_SPP = 2
endif
raw         = $(plan_pictures:%=$(OUT)/raw/%.exr)
raw_channels = RGBA,layers,Z,N,id,albedo,motion,coverage,samples
options_raw = --size $(SIZE) --spp $(FILTER_SPP) --pixel-error $(ERROR) --for-filter --seed-mode frame --channels $(raw_channels) --compression none --camera $(CAMERA) $(shared)
options_filter = $(FILTER) --channels $(CHANNELS)
STAGES     += raw
$(if $(filter 3 5 7 9,$(FILTER)),,$(error FILTER=$(FILTER): an odd number of frames, 3, 5, 7 or 9))
$(if $(plan_frames),$(shell mkdir -p $(OUT)/raw)$(call note,raw)$(call note,filter))

# Of each picture FFFF: where it is among the pictures of its window, and these. A window ends where a frame's number is missing, as flow leads to
# the next one; pictures of frames that show the same are in it once.
windows := $(if $(plan_frames),$(shell awk -v frames='$(foreach f,$(plan_frames),$f:$(or $(picture_$f),$f))' -v width=$(FILTER) 'BEGIN { \
  reach = (width - 1) / 2; n = split(frames, all, " "); \
  for (i = 1; i <= n; ++i) { split(all[i], one, ":"); name[i] = one[1]; shows[i] = one[2] } \
  for (i = 1; i <= n; ++i) if (name[i] == shows[i]) { \
    first = last = i; \
    while (first > 1 && i - first < reach && name[first - 1] == name[first] - 1) --first; \
    while (last < n && last - i < reach && name[last + 1] == name[last] + 1) ++last; \
    list = ""; count = 0; previous = ""; \
    for (k = first; k <= last; ++k) { \
      if (shows[k] != previous) { list = list "+" shows[k]; ++count; previous = shows[k] } \
      if (k == i) at = count } \
    print name[i] ":" at ":" substr(list, 2) } }'))
note_window = $(eval place_$(word 1,$1) := $(word 2,$1))$(eval window_$(word 1,$1) := $(subst +, ,$(word 3,$1)))
$(foreach w,$(windows),$(call note_window,$(subst :, ,$w)))

# Few samples, and what the filter reads.
$(raw): $(OUT)/raw/%.exr: $$(camera_$$*) $$(light_$$*) $$(call lit_files,$$(photons_$$*)) $$(call lights_of,$$*) $(OUT)/options/raw $(BIN)/frame-render
	$(RUN) $(BIN)/frame-render $(SCENE) --frame $* $(call lit,$(photons_$*)) $(addprefix --lights ,$(call lights_of,$*)) $(options_raw) -o $@ --stats $(@:.exr=.json)

$(clear): %.exr: $$(foreach f,$$(window_$$(*F)),$(OUT)/raw/$$f.exr) $(OUT)/options/filter $(BIN)/st-filter
	$(RUN) $(BIN)/st-filter $(filter %.exr,$^) --position $(place_$(*F)) --channels $(CHANNELS) -o $@ --stats $(@:.exr=.json)
